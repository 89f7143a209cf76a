"""study.toml: materials and their rendered models, sessions, rules, questions."""

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, ClassVar, Literal, NamedTuple

from annotated_types import Gt, Interval
from pydantic import TypeAdapter

from springpot.codegen.errors import UsageError
from springpot.host.emission.scene_file import checked_keys, toml_as_json

UPPER_BOUND, LOWER_BOUND, RENDERED = "REAL", "lower bound", "rendered"
_MAX_BYTES = 1_000_000
_Positive = Annotated[float, Gt(0)]


class _Closed:
    """Part of a study file: unknown keys and values of another type are refused."""

    __pydantic_config__: ClassVar = {"extra": "forbid", "allow_inf_nan": False, "strict": True}


@dataclass(frozen=True)
class StudyMaterial(_Closed):
    """A real object, and its renderings: method -> scene file, beside the study file."""

    name: str
    scenes: dict[str, str]


class Condition(NamedTuple):
    """Pair that a trial compares. first: a real object; second: another one, or RENDERED."""

    method: str
    material: str
    first: str
    second: str


@dataclass(frozen=True)
class Study(_Closed):
    """A study file.

    seed: of orders and sides. practice: trials before the first session, which do not count.
    lower_bound: the two materials that differ most, compared so many times a session.
    exclude_repeat_sd_above, exclude_side_difference_above: points of the rating beyond which a
    participant is left out, see `report.consistency`. warn_depth, warn_speed: times the trained
    depth and speed, beyond which the participant is warned.
    """

    schema: Literal[1]
    name: str
    seed: Annotated[int, Interval(ge=0, le=2**32 - 1)]
    sessions: Annotated[int, Interval(ge=1, le=100)]
    material: list[StudyMaterial]
    practice: Annotated[int, Interval(ge=0, le=1000)] = 0
    lower_bound: tuple[str, str] | None = None
    lower_bound_trials: Annotated[int, Interval(ge=1, le=100)] = 1
    exclude_repeat_sd_above: _Positive | None = None
    exclude_side_difference_above: _Positive | None = None
    warn_depth: _Positive = 1.0
    warn_speed: _Positive = 4.0
    questions: list[str] = field(default_factory=list)

    @property
    def materials(self) -> list[str]:
        """Levels of the factor Material."""
        return [material.name for material in self.material]

    @property
    def methods(self) -> list[str]:
        """Levels of the factor Method: the renderings, then REAL, two blocks of one material."""
        return [*self.material[0].scenes, UPPER_BOUND]

    def conditions(self) -> list[Condition]:
        """Return each condition once: all methods of each material, then the lower bound."""
        pairs = []
        for name in self.materials:
            real = f"real {name}"
            pairs += [Condition(method, name, real, real if method == UPPER_BOUND else RENDERED)
                      for method in self.methods]  # fmt: skip
        if self.lower_bound is not None:
            both = [f"real {name}" for name in self.lower_bound]
            pairs.append(Condition(LOWER_BOUND, " | ".join(self.lower_bound), *both))
        return pairs

    def session_trials(self) -> list[Condition]:
        """Return the conditions of a session, not yet in order."""
        again = self.conditions()[-1:] if self.lower_bound is not None else []
        return self.conditions() + again * (self.lower_bound_trials - 1)


def read_study(file: Path) -> Study:
    """Read a study file. Raises UsageError that names the key, its value and what it may be."""
    study = checked_keys(
        TypeAdapter(Study), toml_as_json(file, _MAX_BYTES, "study file"), str(file),
        lambda place: [key.name for key in fields(StudyMaterial if place else Study)],
    )  # fmt: skip
    if problem := _problem(study):
        raise UsageError(f"{file}: {problem}")
    return study


def _problem(study: Study) -> str:
    """Return the first thing that types alone do not refuse, or an empty text."""
    names = study.materials
    if not names or not study.material[0].scenes:
        return "material: no scene: add a [[material]] with scenes for every object"
    methods, most, problems = study.methods[:-1], len(study.session_trials()), list[str]()
    for one in study.material:
        if names.count(one.name) > 1 or not one.name.strip() or not one.name.isprintable():
            problems.append(
                f"material {one.name!r}: give every material a printable name of its own"
            )
        if list(one.scenes) != methods:
            problems.append(f"material {one.name!r}: give it scenes of {', '.join(methods)}")
    for method in methods:
        if not method.replace("-", "").isalnum() or method == UPPER_BOUND:
            problems.append(f"method {method!r}: give letters, digits and hyphens, and not REAL")
    for name in study.lower_bound or ():
        if name not in names:
            problems.append(f"lower_bound: no material {name!r}: known here are {', '.join(names)}")
    if study.practice > most:
        problems.append(f"practice: {study.practice} trials: a session has {most}, give no more")
    return problems[0] if problems else ""
