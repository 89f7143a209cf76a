"""study.toml: what is compared with what, how people are asked, how often, and in which order."""

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Gt, Interval
from pydantic import TypeAdapter

from springpot.codegen.errors import UsageError
from springpot.host.console.toml_file import checked_keys, toml_as_json

MethodName = Literal["similarity", "constant", "staircase", "quest+", "abx", "same-different"]
ADAPTIVE = ("staircase", "quest+")
_CLOSED = {"extra": "forbid", "allow_inf_nan": False, "strict": True}
_MAX_BYTES = 1 << 18


@dataclass(frozen=True)
class Stimulus:
    """Something to press: an emitted scene (a scene file or an emitted folder), or a real object.

    stiffer: the force at a depth is the scene's at so many times that depth. level: its place on
    the scale that a psychometric function is drawn over; by default `stiffer`. max_depth_mm: how
    deep it may be pressed; by default the scene's trained depth. simulated: URL of the object that
    stands for a real one when people are simulated.
    """

    __pydantic_config__ = _CLOSED
    name: str
    scene: str | None = None
    real: str | None = None
    stiffer: Annotated[float, Interval(gt=0, le=100)] = 1.0
    level: float | None = None
    max_depth_mm: Annotated[float, Gt(0)] | None = None
    simulated: str | None = None

    @property
    def at_level(self) -> float:
        return self.stiffer if self.level is None else self.level


@dataclass(frozen=True)
class ComparedPair:
    """One condition. left, right: names of stimuli; of psychometric methods standard, comparison.

    repeats: trials of it in a session. sides: "balanced" swaps left and right in half of them.
    factors: levels for the analysis of variance; a pair without is left out of that.
    series: pairs of one psychometric function, or of one staircase.
    """

    __pydantic_config__ = _CLOSED
    left: str
    right: str
    repeats: Annotated[int, Interval(ge=1, le=1000)] = 1
    sides: Literal["balanced", "fixed"] = "balanced"
    factors: dict[str, str] = field(default_factory=dict)
    series: str = ""

    @property
    def title(self) -> str:
        return f"{self.left} | {self.right}"


@dataclass(frozen=True)
class StaircaseRule:
    """One up, `down` down, on the levels of a series, from the easiest.

    down 2 settles at 70.7 % correct, 3 at 79.4 %. It ends after so many reversals, of which the
    first `skipped` do not count, or after so many trials.
    """

    __pydantic_config__ = _CLOSED
    down: Literal[2, 3] = 2
    reversals: Annotated[int, Interval(ge=4, le=100)] = 12
    skipped: Annotated[int, Interval(ge=0, le=50)] = 4
    trials: Annotated[int, Interval(ge=4, le=1000)] = 80


@dataclass(frozen=True)
class QuestRule:
    """How many trials of QUEST+ a series gets."""

    __pydantic_config__ = _CLOSED
    trials: Annotated[int, Interval(ge=4, le=1000)] = 40


@dataclass(frozen=True)
class StudyLimits:
    """When people are warned: beyond a depth, by default the trained one; warn_speed: x trained."""

    __pydantic_config__ = _CLOSED
    warn_depth_mm: Annotated[float, Gt(0)] | None = None
    warn_speed: Annotated[float, Gt(0)] = 4.0


@dataclass(frozen=True)
class Exclude:
    """Rules that are decided before the data; None: no such rule.

    repeat_sd_above: mean over conditions of the standard deviation of repeated answers.
    side_difference_above: mean answer with the first stimulus left less that with it right.
    """

    __pydantic_config__ = _CLOSED
    repeat_sd_above: Annotated[float, Gt(0)] | None = None
    side_difference_above: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True)
class EquivalenceRule:
    """Two conditions are alike when their means differ by less than `margin`, in answers.

    sd: standard deviation of one person's difference between two conditions that the plan expects.
    """

    __pydantic_config__ = _CLOSED
    margin: Annotated[float, Gt(0)]
    sd: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True)
class Question:
    """Asked at the end. choices: numbered answers; none: free text."""

    __pydantic_config__ = _CLOSED
    text: str
    choices: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Study:
    """A whole study file.

    practice: trials before the first session that do not count. trial_minutes: what the plan
    reckons with. ask: the question of a trial, where the method's own does not serve.
    """

    __pydantic_config__ = _CLOSED
    schema: Literal[1]
    name: str
    method: MethodName
    stimulus: list[Stimulus]
    pair: list[ComparedPair]
    sessions: Annotated[int, Interval(ge=1, le=100)] = 1
    order: Literal["random", "williams"] = "random"
    practice: Annotated[int, Interval(ge=0, le=100)] = 0
    trial_minutes: Annotated[float, Gt(0)] = 1.0
    ask: str | None = None
    staircase: StaircaseRule = field(default_factory=StaircaseRule)
    quest: QuestRule = field(default_factory=QuestRule)
    limits: StudyLimits = field(default_factory=StudyLimits)
    exclude: Exclude = field(default_factory=Exclude)
    equivalence: EquivalenceRule | None = None
    question: list[Question] = field(default_factory=list)

    def stimulus_of(self, name: str) -> Stimulus:
        """The stimulus of that name."""
        return next(stimulus for stimulus in self.stimulus if stimulus.name == name)

    @property
    def all_series(self) -> tuple[str, ...]:
        """Names of all series, in the file's order."""
        return tuple(dict.fromkeys(pair.series for pair in self.pair))

    def pairs_of(self, series: str) -> list[int]:
        """Indices of the pairs of a series."""
        return [k for k, pair in enumerate(self.pair) if pair.series == series]

    def step(self, pair: int) -> float:
        """How far the comparison's level is from the standard's: the greater, the easier."""
        standard, comparison = self.pair[pair].left, self.pair[pair].right
        return abs(self.stimulus_of(comparison).at_level - self.stimulus_of(standard).at_level)

    @property
    def adaptive(self) -> bool:
        """Whether levels depend on earlier answers."""
        return self.method in ADAPTIVE


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
    """What the types alone cannot say is wrong, the first things first."""
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
