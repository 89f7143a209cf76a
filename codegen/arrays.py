"""Names for arrays that every floor uses, and arrays that a person gives."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.errors import DataError

Samples = NDArray[np.float64]
Indices = NDArray[np.intp]  # indices of samples
Flags = NDArray[np.bool_]
Real = np.float32 | np.float64
Reals = NDArray[Any]  # of a scene's number type


def to_float64(values: Any, argument: str) -> Samples:
    """Float64 of an argument. Raises DataError that names it where it holds more than numbers.

    >>> given_numbers([1, 2.5], "position_m")
    array([1. , 2.5])
    """
    if np.ma.is_masked(values):
        raise DataError(f"{argument}: has masked samples: cut or repair them in the source")
    what = "more than numbers"
    try:
        given = np.asarray(values)
        texts = given.dtype.kind == "O" and any(isinstance(x, str | bytes) for x in given.flat)
        if texts or given.dtype.kind in "US":
            what = "text"
        elif given.dtype.kind in "iufO":
            return given.astype(np.float64, copy=False)
        else:
            what = str(given.dtype)  # truths, dates, complex numbers
    except (TypeError, ValueError):
        pass
    raise DataError(f"{argument}: holds {what}: give one number a sample")


def to_readonly_float64(values: Any, argument: str) -> Samples:
    """Convert as `to_float64` does, to a read-only array: a copy if the argument is writable."""
    array = to_float64(values, argument)
    if array.flags.writeable or array.base is not None:
        array = array.copy()
        array.setflags(write=False)
    return array


def require(fits: bool, what: str) -> None:
    """Raise DataError where something does not fit."""
    if not fits:
        raise DataError(what)


def require_shape(name: str, values: NDArray[np.generic], shape: tuple[int, ...]) -> None:
    """Raise DataError for an array of another shape."""
    require(values.shape == shape, f"{name}: shape {values.shape}, not {shape}")


def require_positive(name: str, values: Samples, shape: tuple[int, ...]) -> None:
    """Raise DataError for an array of another shape, or with numbers at or below 0."""
    require_shape(name, values, shape)
    require(bool(np.all(values > 0.0)), f"{name}: not above 0")


def require_not_negative(name: str, values: Samples, shape: tuple[int, ...]) -> None:
    """Raise DataError for an array of another shape, or with numbers below 0."""
    require_shape(name, values, shape)
    require(bool(np.all(values >= 0.0)), f"{name}: negative")


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Begin and end (exclusive) of each run of true.

    >>> runs(np.array([True, False, True, True]))
    [(0, 1), (2, 4)]
    """
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0)).tolist()
    return list(zip(edges[::2], edges[1::2], strict=True))


def rms(values: Samples) -> float:
    """Root mean square.

    >>> rms(np.array([3.0, 4.0]))
    3.5355339059327378
    """
    return float(np.sqrt(np.mean(np.square(values))))
