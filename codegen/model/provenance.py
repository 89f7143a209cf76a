"""Checks of the items of a model's provenance that commands read: the rest of it is for people."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from springpot.codegen.errors import DataError


def require_provenance(metadata: Mapping[str, Any]) -> None:
    """Raise DataError naming the first item that is not what its readers take."""
    for name, (fits, wanted) in _ITEMS.items():
        if name in metadata and not fits(metadata[name]):
            raise DataError(f"provenance.{name}: {wanted}")
    if not _is_finite_json(metadata):
        raise DataError("provenance: a number that is not finite")


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _not_negative(value: Any) -> bool:
    return _number(value) and value >= 0


def _numbers(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(map(_number, value))


def _texts(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(text, str) for text in value.values())


def _names(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(text, str) for text in value)


def _zero(value: Any) -> bool:
    return isinstance(value, str) and value in {"none", "first", "min"}


_ITEMS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "seed": (_whole, "no whole number of 0 or more"),
    "rows": (_whole, "no whole number of 0 or more"),
    "rows_total": (_whole, "no whole number of 0 or more"),
    "smooth_s": (_not_negative, "no number of 0 or more"),
    "zero": (_zero, "none of none, first, min"),
    "share_of_trees": (_not_negative, "no number of 0 or more"),
    "recordings": (_texts, "no hash for each name"),
    "accepted_signs": (_names, "no list of names"),
    "importance": (_numbers, "no list of numbers"),
}


def _is_finite_json(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    items = value.values() if hasattr(value, "values") else value
    return not isinstance(value, list | tuple | dict) or all(map(_is_finite_json, items))
