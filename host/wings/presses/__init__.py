"""Choose what to record: presses that would tell most, protocols of places and of failures."""
