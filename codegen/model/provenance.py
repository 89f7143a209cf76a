"""Checks of the items of a model's provenance that commands read: the rest of it is for people."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from springpot.codegen.errors import DataError

_LAW = ("stiffness_npm", "coefficient", "order")


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


def _number_or_none(value: Any) -> bool:
    return value is None or _number(value)


def _not_negative(value: Any) -> bool:
    return _number(value) and value >= 0


def _numbers(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(map(_number, value))


def _range(value: Any) -> bool:
    return value is None or (_numbers(value) and len(value) == 2 and value[0] <= value[1])


def _texts(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(text, str) for text in value.values())


def _names(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(text, str) for text in value)


def _rows(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(
        isinstance(row, Mapping) and all(map(_number, row.values())) for row in value
    )


def _zero(value: Any) -> bool:
    return isinstance(value, str) and value in {"none", "first", "min"}


def _law(value: Any) -> bool:
    return (
        isinstance(value, Mapping)
        and all(name in value for name in _LAW)
        and all(
            isinstance(pair, list | tuple)
            and len(pair) == 2
            and _number(pair[0])
            and _number_or_none(pair[1])
            for pair in value.values()
        )
    )


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
    "material": (_law, f"not {', '.join(_LAW)}, each a number and its half width or null"),
    "not_identified": (_texts, "no reason for each name"),
    "residual_percent": (_number_or_none, "no number"),
    "covered_hz": (_range, "no two ascending numbers"),
    "measured": (_rows, "no list of rows of numbers"),
}


def _is_finite_json(value: Any) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    items = value.values() if hasattr(value, "values") else value
    return not isinstance(value, list | tuple | dict) or all(map(_is_finite_json, items))
