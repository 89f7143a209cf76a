"""Boards: firmware and emulator; `springpot firmware`."""

from springpot.console import LazyCommand

FIRMWARE = LazyCommand("springpot.host.wings.boards.command:firmware", place=10)
