"""Devices of hardware: boards on a serial line, ODrive drives, Force Dimension's devices."""
