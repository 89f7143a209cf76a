"""study.toml: what is compared with what, how people are asked, how often, and in which order."""

from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

from annotated_types import Gt, Interval

MethodName = Literal["similarity", "constant", "staircase", "quest+", "abx", "same-different"]
ADAPTIVE = ("staircase", "quest+")


class _Closed:
    """Part of a study file: unknown keys and values of another type are refused."""

    __pydantic_config__: ClassVar = {"extra": "forbid", "allow_inf_nan": False, "strict": True}


@dataclass(frozen=True)
class Stimulus(_Closed):
    """Something to press: an emitted scene (a scene file or an emitted folder), or a real object.

    stiffer: the force at a depth is the scene's at so many times that depth. level: its place on
    the scale that a psychometric function is drawn over; by default `stiffer`. max_depth_mm: how
    deep it may be pressed; by default the scene's trained depth. simulated: URL of the object that
    stands for a real one when people are simulated.
    """

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
class ComparedPair(_Closed):
    """One condition. left, right: names of stimuli; of psychometric methods standard, comparison.

    repeats: trials of it in a session. sides: "balanced" swaps left and right in half of them.
    factors: levels for the analysis of variance; a pair without is left out of that.
    series: pairs of one psychometric function, or of one staircase.
    """

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
class StaircaseRule(_Closed):
    """One up, `down` down, on the levels of a series, from the easiest.

    down 2 settles at 70.7 % correct, 3 at 79.4 %. It ends after so many reversals, of which the
    first `skipped` do not count, or after so many trials.
    """

    down: Literal[2, 3] = 2
    reversals: Annotated[int, Interval(ge=4, le=100)] = 12
    skipped: Annotated[int, Interval(ge=0, le=50)] = 4
    trials: Annotated[int, Interval(ge=4, le=1000)] = 80


@dataclass(frozen=True)
class QuestRule(_Closed):
    """How many trials of QUEST+ a series gets."""

    trials: Annotated[int, Interval(ge=4, le=1000)] = 40


@dataclass(frozen=True)
class StudyLimits(_Closed):
    """When people are warned: beyond a depth, by default the trained one; warn_speed: x trained."""

    warn_depth_mm: Annotated[float, Gt(0)] | None = None
    warn_speed: Annotated[float, Gt(0)] = 4.0


@dataclass(frozen=True)
class Exclude(_Closed):
    """Rules that are decided before the data; None: no such rule.

    repeat_sd_above: mean over conditions of the standard deviation of repeated answers.
    side_difference_above: mean answer with the first stimulus left less that with it right.
    """

    repeat_sd_above: Annotated[float, Gt(0)] | None = None
    side_difference_above: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True)
class EquivalenceRule(_Closed):
    """Two conditions are alike when their means differ by less than `margin`, in answers.

    sd: standard deviation of one person's difference between two conditions that the plan expects.
    """

    margin: Annotated[float, Gt(0)]
    sd: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True)
class Question(_Closed):
    """Asked at the end. choices: numbered answers; none: free text."""

    text: str
    choices: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Study(_Closed):
    """A whole study file.

    practice: trials before the first session that do not count. trial_minutes: what the plan
    reckons with. ask: the question of a trial, where the method's own does not serve.
    """

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
        """Return the stimulus of that name."""
        return next(stimulus for stimulus in self.stimulus if stimulus.name == name)

    @property
    def all_series(self) -> tuple[str, ...]:
        """Names of all series, in the file's order."""
        return tuple(dict.fromkeys(pair.series for pair in self.pair))

    def pairs_of(self, series: str) -> list[int]:
        """Return indices of the pairs of a series."""
        return [k for k, pair in enumerate(self.pair) if pair.series == series]

    def step(self, pair: int) -> float:
        """Return how far the comparison's level is from the standard's: the greater, the easier."""
        standard, comparison = self.pair[pair].left, self.pair[pair].right
        return abs(self.stimulus_of(comparison).at_level - self.stimulus_of(standard).at_level)

    @property
    def adaptive(self) -> bool:
        """Whether levels depend on earlier answers."""
        return self.method in ADAPTIVE
