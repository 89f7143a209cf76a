"""Fields of a model's parts against their annotations: what a type alone can say."""

import types
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from springpot.codegen.errors import DataError

MAX_NUMBER = 1e30  # the C's float ends at 3.4e38: room for a product with what is usual
_MAX_LETTERS = 200
_MAX_ITEMS = 10_000  # of a tuple


def require_types(part: type[Any], values: Mapping[str, Any], where: str) -> None:
    """Refuse fields that are missing, unknown, of another type, not finite or unprintable."""
    hints = get_type_hints(part)
    if unknown := sorted(set(values) - {field.name for field in fields(part)}):
        raise DataError(f"{where}: unknown {part.__name__} field {unknown[0]!r}")
    required = {f.name for f in fields(part) if f.default is f.default_factory}  # both MISSING
    if missing := sorted(required - set(values)):
        raise DataError(f"{where}.{missing[0]}: missing")
    for name, value in values.items():
        if reason := _wrong(value, hints[name]):
            raise DataError(f"{where}.{name}: {reason}")


def _wrong(value: Any, hint: Any) -> str | None:
    """Why the value is not of this annotated type; None where it is."""
    origin = get_origin(hint)
    if origin in (Union, types.UnionType):
        one_of = get_args(hint)
        fits = value is None and type(None) in one_of
        return None if fits else _wrong(value, next(item for item in one_of if item))
    wanted = origin or hint
    if wanted in _WRONG:
        return _WRONG[wanted](value, hint)
    return None if isinstance(value, wanted) else f"{_shown(value)} is no {wanted.__name__}"


def _wrong_word(value: Any, hint: Any) -> str | None:
    words = get_args(hint)
    fits = isinstance(value, str) and value in words
    return None if fits else f"{_shown(value)} is none of {', '.join(words)}"


def _wrong_list(value: Any, hint: Any) -> str | None:
    if not isinstance(value, tuple) or len(value) > _MAX_ITEMS:
        return f"{_shown(value)} is no list of at most {_MAX_ITEMS}"
    return next((why for item in value if (why := _wrong(item, get_args(hint)[0]))), None)


def _wrong_text(value: Any, _: Any) -> str | None:
    fits = isinstance(value, str) and value.isprintable() and 0 < len(value) <= _MAX_LETTERS
    return None if fits else f"{_shown(value)} is no printable text"


def _wrong_number(value: Any, hint: Any) -> str | None:
    number = isinstance(value, int if hint is int else int | float) and not isinstance(value, bool)
    if number and -MAX_NUMBER <= value <= MAX_NUMBER:  # NaN is not
        return None
    return f"{_shown(value)} is no {'whole' if hint is int else 'finite'} number"


def _wrong_array(value: Any, hint: Any) -> str | None:
    dtype = np.dtype(get_args(get_args(hint)[1])[0])
    if not isinstance(value, np.ndarray):
        return f"{_shown(value)} is no array"
    if value.dtype != dtype:
        return f"an array of {value.dtype}, not of {dtype}"
    # Extremes alone: no array of booleans is made. Comparisons with NaN are false.
    if value.size and not (value.min() >= -MAX_NUMBER and value.max() <= MAX_NUMBER):
        return f"a number that is not finite, or above {MAX_NUMBER:g}"
    return None


_WRONG: dict[Any, Callable[[Any, Any], str | None]] = {
    Literal: _wrong_word,
    np.ndarray: _wrong_array,
    tuple: _wrong_list,
    str: _wrong_text,
    int: _wrong_number,
    float: _wrong_number,
}


def _shown(value: Any) -> str:
    text = repr(value) if isinstance(value, str | int | float | None) else type(value).__name__
    return text if len(text) <= 60 else f"{text[:57]}..."
