"""Pressing an object under force control: protocols, indentation, one recording a press."""
