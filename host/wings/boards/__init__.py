"""Boards that render a scene themselves: recordings replayed through them."""
