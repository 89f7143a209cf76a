"""The command that says what material a fitted springpot is."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.material.commands"
MATERIAL = LazyCommand(
    f"{_HERE}.material:material",
    "Material of a MODEL of kind springpot: shear moduli need the tip's size, else stiffness.",
    21,
)
