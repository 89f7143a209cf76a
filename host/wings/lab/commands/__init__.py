"""Commands that measure a device and find the surface."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.lab.commands"
PLACE = LazyCommand(
    f"{_HERE}.place:place",
    "Find the surface: touch it with the tool three times, the Enter key each time.",
    14,
)
IDENTIFY = LazyCommand(
    f"{_HERE}.identify:identify",
    "Measure a device that nobody holds: mass, friction, delay, sensors. It moves by itself.",
    15,
)
