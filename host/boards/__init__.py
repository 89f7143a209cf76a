"""Microcontrollers: boards, firmware, emulator, replay through a board."""
