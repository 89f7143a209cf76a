"""Floor 1: the C that runs, and where to find it. Knows nobody."""
