"""What every stage of a model tells: headers, state, tables, lines of glue, and its reference."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Real = np.float32 | np.float64
Reals = NDArray[Any]
Starts = NDArray[np.intp]  # ticks at which the history restarts with the sample held

REAL, U32, DOUBLE = "real", "u32", "double"
LANES = 4  # SP_LANES of sp_weighted_sum.h
SMALLEST = 1e-30  # SP_SMALLEST of sp_number.h


@dataclass(frozen=True)
class Member:
    """One member of sp_state: C declaration and the scalars in it, for the size."""

    declaration: str
    scalars: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Probe:
    """Sums of made-up inputs whose bits the self-test compares.

    call: C that fills `sums` from `in`. sums: the same in numpy, from (inputs,) to (outputs,).
    """

    inputs: int
    outputs: int
    call: str
    sums: Callable[[Reals], Reals]


@dataclass(frozen=True)
class Measured:
    """A stage over a measured time step, `dt_s` of the C: headers, tables, lines of every tick."""

    headers: tuple[str, ...]
    tables: tuple[str, ...]
    advance: tuple[str, ...]


class Stage(Protocol):
    """A part of the tick with a state. Lines of C see `state`, `depth` and what they declare."""

    @property
    def headers(self) -> tuple[str, ...]:
        """Headers of runtime_c/src, those that they include first."""
        ...

    @property
    def members(self) -> tuple[Member, ...]:
        """What it keeps from tick to tick."""
        ...

    def tables(self) -> list[str]:
        """Definitions of its constant arrays and sizes."""
        ...

    def restart(self) -> list[str]:
        """Lines that forget the past: the object has rested at `depth` for ever."""
        ...

    def advance(self) -> list[str]:
        """Lines of every tick."""
        ...

    @property
    def measured(self) -> Measured | None:
        """The same over a measured time step; None where the stage is exact at one rate only."""
        ...


class FeatureStage(Stage, Protocol):
    """Fills `features`."""

    @property
    def n_features(self) -> int:
        """Features that the regressor uses."""
        ...

    @property
    def room(self) -> int:
        """Length of the array that `read` fills."""
        ...

    def read(self) -> list[str]:
        """Lines that fill `features`."""
        ...

    def probe(self) -> Probe | None:
        """Its sums, where it has any: leaves of trees hide small differences of features."""
        ...

    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """The features of every tick, shape (n, n_features)."""
        ...


class RegressorStage(Protocol):
    """Features -> force."""

    @property
    def headers(self) -> tuple[str, ...]:
        """Headers of runtime_c/src, those that they include first."""
        ...

    @property
    def members(self) -> tuple[Member, ...]:
        """What sp_init finds out once."""
        ...

    def init(self) -> list[str]:
        """Lines of sp_init."""
        ...

    def tables(self) -> list[str]:
        """Definitions of its constant arrays and sizes."""
        ...

    def force(self) -> list[str]:
        """Lines that declare `model_n` from `features`."""
        ...

    def reference(self, features: Reals) -> Reals:
        """Force of each row of features, N."""
        ...


def flushed(x: Any) -> Any:
    """sp_flushed: one number, or 0 where it would be near denormal."""
    return x.dtype.type(0) if abs(x) < x.dtype.type(SMALLEST) else x


def padded(n: int, lanes: int = LANES) -> int:
    """Return n rounded up to whole vectors."""
    return -(-n // lanes) * lanes


def segments(length: int, starts: Starts) -> list[tuple[int, int, bool]]:
    """Stretches (begin, end, held) between restarts; before the first one nothing is held."""
    bounds = [0, *starts.tolist(), length]
    return [(begin, end, bool(i)) for i, (begin, end) in enumerate(pairwise(bounds)) if begin < end]


def held_before(depth: Reals, starts: Starts, length: int) -> list[tuple[slice, Reals]]:
    """For each stretch, its rows and its samples with `length` samples of the past in front."""
    zero = depth.dtype.type(0)
    return [
        (slice(begin, end), np.concatenate(
            [np.full(length, depth[begin] if held else zero, dtype=depth.dtype), depth[begin:end]]
        ))
        for begin, end, held in segments(len(depth), starts)
    ]  # fmt: skip
