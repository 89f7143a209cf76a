"""Will a hand find the scene stable, and faithful: linear loop, small signals, closed loop."""
