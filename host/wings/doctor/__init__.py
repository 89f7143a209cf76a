"""`springpot doctor`: checks of this machine, and of a device before its first session."""

from springpot.console import LazyCommand

DOCTOR = LazyCommand("springpot.host.wings.doctor.command:doctor", place=0)
