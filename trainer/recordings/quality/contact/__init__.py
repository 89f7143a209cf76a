"""Checks of the contact with the object."""
