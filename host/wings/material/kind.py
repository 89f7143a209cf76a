"""The kind of model `springpot`: registered in pyproject.toml."""

from springpot.modelling import Kind

SPRINGPOT = Kind(
    "springpot",
    "a fractional solid: three or four numbers",
    "springpot.host.wings.material.law.springpot:fit_springpot",
    "*",
    "#6c584c",
    7,
)
