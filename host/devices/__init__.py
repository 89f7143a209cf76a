"""Devices by URL: serial, ODrive, virtual ones; what this machine offers."""
