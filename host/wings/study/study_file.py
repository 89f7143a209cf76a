"""Study files: TOML, checked key by key, and as a whole."""

import dataclasses
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from springpot import UsageError
from springpot.console import checked_keys, toml_as_json
from springpot.host.wings.study.definition import (
    ADAPTIVE,
    ComparedPair,
    EquivalenceRule,
    Exclude,
    Question,
    QuestRule,
    StaircaseRule,
    Stimulus,
    Study,
    StudyLimits,
)

_MAX_BYTES = 1 << 18
_ADAPTER = TypeAdapter(Study)
_SECTIONS = {"stimulus": Stimulus, "pair": ComparedPair, "staircase": StaircaseRule,
             "quest": QuestRule, "limits": StudyLimits, "exclude": Exclude,
             "equivalence": EquivalenceRule, "question": Question}  # fmt: skip


def read_study(path: Path) -> Study:
    """Read a study file. Raises UsageError that names the key, its value and what it may be."""
    text = toml_as_json(path, _MAX_BYTES, "study file")
    study = checked_keys(_ADAPTER, text, str(path), _known_keys)
    for found in _problems(study):
        raise UsageError(f"{path}: {found}")
    return study


def _known_keys(place: tuple[Any, ...]) -> list[str]:
    section: Any = _SECTIONS.get(str(place[0]), Study) if place else Study
    return [key.name for key in dataclasses.fields(section)]


def _problems(study: Study) -> list[str]:
    """Return what the types alone cannot say is wrong, the first things first."""
    names = [stimulus.name for stimulus in study.stimulus]
    found = [
        *(f"stimulus {name!r}: twice: give every stimulus a name of its own"
          for name in names if names.count(name) > 1),
        *(f"stimulus {one.name!r}: give it either scene = ... or real = ..."
          for one in study.stimulus if (one.scene is None) == (one.real is None)),
        *(f"stimulus {one.name!r}: stiffer is of a scene: leave it out of a real object"
          for one in study.stimulus if one.real is not None and one.stiffer != 1),
        *(f"pair {k + 1}: no stimulus {name!r}: known here are {', '.join(names)}"
          for k, pair in enumerate(study.pair) for name in (pair.left, pair.right)
          if name not in names),
    ]  # fmt: skip
    if not study.name.isprintable() or not study.name.strip():
        found.append(f"name: {study.name!r}: give a printable name")
    if not study.pair:
        found.append("pair: none: add a [[pair]] for every condition")
    return found or [*_factor_problems(study), *_method_problems(study)]


def _factor_problems(study: Study) -> list[str]:
    kinds = {tuple(sorted(pair.factors)) for pair in study.pair if pair.factors}
    if len(kinds) > 1:
        return ["factors: every pair that has factors needs the same ones: "
                + " / ".join(", ".join(kind) for kind in sorted(kinds))]  # fmt: skip
    if kinds and len(next(iter(kinds))) > 2:
        return ["factors: at most two, the analysis of variance has two ways"]
    return []


def _method_problems(study: Study) -> list[str]:
    found = []
    if study.method in ("constant", *ADAPTIVE):
        by_series: dict[str, set[str]] = {}
        for pair in study.pair:
            by_series.setdefault(pair.series, set()).add(pair.left)
        found += [
            f"series {series!r}: {' and '.join(sorted(standards))} are its standards: give one "
            "standard as `left` of all its pairs"
            for series, standards in by_series.items()
            if len(standards) > 1
        ]
    if study.method in ADAPTIVE:
        for series in study.all_series:
            steps = [study.step(k) for k in study.pairs_of(series)]
            if len(steps) < 3 or len(set(steps)) < len(steps) or 0 in steps:
                found.append(
                    f"series {series!r}: a {study.method} needs at least three pairs, each `right` "
                    "another step away from the standard's level, none at it"
                )
        if study.method == "staircase" and study.staircase.skipped >= study.staircase.reversals:
            found.append("staircase: more reversals have to be made than are skipped")
        if study.order == "williams":
            found.append(f"order: williams is for fixed trials: {study.method} picks its own")
    if study.method in ("abx", "same-different"):
        found += [
            f"pair {k + 1}: {pair.left!r} on both sides: {study.method} compares two stimuli"
            for k, pair in enumerate(study.pair)
            if pair.left == pair.right
        ]
    if study.order == "williams" and any(pair.repeats > 1 for pair in study.pair):
        found.append("order: williams shows every pair once a session: set repeats = 1, more "
                     "sessions instead")  # fmt: skip
    return found
