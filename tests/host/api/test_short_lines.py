"""Public dataclasses print as one short line."""

import dataclasses
from importlib import import_module
from typing import get_args

from support.pages.sources import API
from support.small import passive_model

import springpot


def public_dataclasses():
    modules = [springpot, *(import_module(f"springpot.{name}") for name in
               {file.stem for file in API.glob("*.py")} - {"__init__", "files", "lazy_names",
                                                           "loaded", "steps"})]  # fmt: skip
    found = [getattr(module, name) for module in modules for name in module.__all__]
    return [each for each in found if isinstance(each, type) and dataclasses.is_dataclass(each)]


def is_plain(kind):
    """Whether a field's type is a number, a truth, one of some words, or a name."""
    parts = get_args(kind)
    if hasattr(kind, "__metadata__"):
        return is_plain(parts[0])
    return kind in (int, float, bool, str, type(None)) or (
        bool(parts) and all(isinstance(part, str | int) or is_plain(part) for part in parts)
    )


def test_every_public_dataclass_has_a_short_line():
    """Those that Python writes itself have few fields, none of which can be long."""
    long = []
    for kind in public_dataclasses():
        shown = [field for field in dataclasses.fields(kind) if field.repr]
        written = hasattr(kind.__repr__, "__wrapped__")  # by dataclasses
        if written and not (len(shown) <= 8 and all(is_plain(field.type) for field in shown)):
            long.append(kind.__name__)
    assert not long
    plan = springpot.emission.make_plan(passive_model(), springpot.Scene(1, "a", "b.spm"))
    model = passive_model().hammerstein
    for each in (plan, model, springpot.FitOptions(orders=(0.1,) * 99, seed=3)):
        assert len(repr(each)) <= 200
    assert repr(springpot.FitOptions(seed=3)) == "FitOptions(seed=3)"
