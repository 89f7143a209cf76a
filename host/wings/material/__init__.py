"""What a material scientist takes from a fitted springpot."""
