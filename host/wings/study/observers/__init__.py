"""Simulated people with known thresholds, who press the emitted C."""
