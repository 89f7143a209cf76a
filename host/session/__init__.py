"""A real-time session: the loop, its supervisor, its log, how it ended."""
