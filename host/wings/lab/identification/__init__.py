"""A device that is free to move, measured: mass, friction, delay, sensors."""
