"""Boards: firmware, emulator, replay through a board and its log."""
