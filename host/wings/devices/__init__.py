"""Devices of makers: ODrive motor drives on a CAN bus, Force Dimension's haptic devices."""
