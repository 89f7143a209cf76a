"""Simulated objects, device and hands, in compiled C; what a hand does in the closed loop."""
