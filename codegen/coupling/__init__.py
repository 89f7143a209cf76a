"""The virtual coupling: exact gains, the linear loop with a hand, the choice that `auto` makes."""
