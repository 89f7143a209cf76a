"""Numpy reference of the emitted C: the same operations in the same order, bit for bit."""
