"""Time-stamped samples as a file has them, and a first row that the others are not in step with."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.short_repr import short_repr

_MANY_STEPS = 20


@dataclass(frozen=True, eq=False)
class RawChannels:
    """Time-stamped samples as a file has them, in SI units, unchecked.

    time_s, position_m, force_n: shape (n,), float64.
    time_digit_s: one unit in the last printed digit of the time stamps; 0 where none was printed.
    source: file and block, for messages and for the recording.
    line_of: the 1-based line of the file on which sample k stands.
    place_m: as in `Recording`, x and y.
    in_python: a refusal names arguments of `Recording.from_frame`, not options of a command.
    """

    name: str
    time_s: Samples
    position_m: Samples
    force_n: Samples
    time_digit_s: float
    source: str
    line_of: Callable[[int], int]
    details: Mapping[str, Any] = field(default_factory=dict)
    place_m: tuple[float, float] | None = None
    in_python: bool = False
    __repr__ = short_repr

    def __post_init__(self) -> None:
        """Raise TypeError here, in its reader, for what would fail only in a later message."""
        if not (isinstance(self.name, str) and isinstance(self.source, str)):
            raise TypeError("RawChannels: give name and source as text, such as str(path)")
        if not callable(self.line_of):
            raise TypeError("RawChannels: give line_of as a function of a sample's number")


def without_odd_first(raw: RawChannels, slack_s: float) -> RawChannels:
    """The samples without the first one where its step alone is not the usual one.

    A logger that starts between two samples: interpolation onto its first stamp would move, and
    blur, all others. slack_s: how far a step may differ from the usual one.
    """
    steps_s = np.diff(raw.time_s)
    off = np.abs(steps_s - np.median(steps_s)) > slack_s
    if len(steps_s) <= _MANY_STEPS or not off[0] or off[1:].any():
        return raw
    line_of = raw.line_of
    return replace(
        raw,
        time_s=raw.time_s[1:],
        position_m=raw.position_m[1:],
        force_n=raw.force_n[1:],
        line_of=lambda sample: line_of(sample + 1),
        details={
            **raw.details,
            "first_row_cut": f"row {line_of(0)} comes {steps_s[0]:.4g} s before the next one, "
            f"where steps are {np.median(steps_s):.4g} s: cut",
        },
    )
