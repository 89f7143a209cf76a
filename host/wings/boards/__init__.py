"""Boards: firmware, emulator, replay through a board and its log; `springpot firmware`."""

from springpot.console import LazyCommand

FIRMWARE = LazyCommand("springpot.host.wings.boards.command:firmware", place=10)
