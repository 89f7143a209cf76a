"""Features along a recording: fractional derivatives, past positions, velocity."""
