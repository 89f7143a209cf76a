"""Faults of one recording: of a channel, of a counter, of what is between tool and sensor."""
