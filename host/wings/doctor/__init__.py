"""`springpot doctor`: checks of this machine."""

from springpot.console import LazyCommand

DOCTOR = LazyCommand("springpot.host.wings.doctor.doctor:doctor", place=0)
