"""What to record: presses that would tell most, and protocols of places and of failures."""
