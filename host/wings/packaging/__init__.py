"""A scene as one source and one header, with what makes them a library: `emit --single`."""
