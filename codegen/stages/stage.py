"""Interface of the stages of a model: headers, state, tables, a template of C, and a reference."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch
from importlib.resources import files
from itertools import pairwise
from math import inf
from typing import ClassVar

import numpy as np

from springpot.codegen.arrays import Indices, Reals
from springpot.codegen.messages import short_repr
from springpot.codegen.model.features import Features
from springpot.codegen.model.formulas import SMALLEST
from springpot.codegen.model.regressors import Regressor
from springpot.codegen.scene import Runtime
from springpot.codegen.types import JsonObject, RealType, Scalar

Columns = Indices
Starts = Indices  # ticks at which the history restarts with the sample held

REAL, U32, DOUBLE = "real", "u32", "double"
VECTOR_WIDTH = 4  # SP_VECTOR_WIDTH of sp_weighted_sum.h
LARGEST = 1e6  # SP_MAX_STATE


@dataclass(frozen=True)
class Member:
    """One member of sp_state: C declaration and the scalars in it, for the size."""

    declaration: str
    scalars: tuple[str, ...]
    __repr__ = short_repr


def window_members(samples: str, newest: str, length: int) -> tuple[Member, Member]:
    """A window, twice so that its samples are contiguous, and where it begins (sp_window.h)."""
    twice = Member(f"sp_real {samples}[2 * {length}]", (REAL,) * (2 * length))
    return twice, Member(f"uint32_t {newest}", (U32,))


@dataclass(frozen=True, eq=False)
class Probe:
    """Sums of made-up inputs; the self-test compares their bits.

    The block `probe` of the stage's template fills `sums` from `in`; sums: the same in numpy, from
    (inputs,) to (outputs,).
    """

    inputs: int
    outputs: int
    sums: Callable[[Reals], Reals]


@dataclass(frozen=True)
class SceneTicks:
    """Figures that all parts of a scene share: its time step, s, and numpy's type of sp_real.

    vector_width: branches that are stepped side by side. surface: the object has one, above which
    positions are free air. start_reach_m: see `Model`.
    """

    dt_s: float
    dtype: RealType = np.float64
    vector_width: int = 1
    surface: bool = False
    start_reach_m: float = inf


class Stage(ABC):
    """A part of the tick with a state.

    code: its C, a jinja2 template with the blocks `restart` (forget the past: the object has rested
    at `clipped_m` for a long time) and `advance` (every tick), indented by four. They see `state`,
    `clipped_m`, `penetration_m` and what they declare; the template sees the stage as `stage`.
    """

    code: ClassVar[str]

    @property
    @abstractmethod
    def headers(self) -> tuple[str, ...]:
        """Headers of runtime_c/src, those that they include first."""

    @property
    @abstractmethod
    def members(self) -> tuple[Member, ...]:
        """State that it keeps from tick to tick."""

    @abstractmethod
    def tables(self) -> list[str]:
        """Definitions of its constant arrays and sizes."""


class FeatureStage(Stage):
    """A stage that fills the C array `features`: in the block `features` of its template."""

    @property
    @abstractmethod
    def n_features(self) -> int:
        """Features that the regressor uses."""

    @property
    def capacity(self) -> int:
        """Length of the array `features`."""
        return self.n_features

    def probe(self) -> Probe | None:
        """Its sums, where it has any: leaves of trees hide small differences of features."""
        return None

    @abstractmethod
    def reference(self, depth: Reals, starts: Starts) -> Reals:
        """Return the features of every tick, shape (n, n_features)."""


class RegressorStage(ABC):
    """Features -> force.

    code: a jinja2 template with a block `force` that declares `model_n` from `features`; one with
    members has a block `init`, for sp_init.
    """

    code: ClassVar[str]

    @property
    @abstractmethod
    def headers(self) -> tuple[str, ...]:
        """Headers of runtime_c/src, those that they include first."""

    @property
    def members(self) -> tuple[Member, ...]:
        """State that sp_init finds out once, and that it keeps from tick to tick."""
        return ()

    @property
    def table_bytes(self) -> int:
        """Bytes of its largest tables: what a budget of flash cannot go below."""
        return 0

    @abstractmethod
    def tables(self) -> list[str]:
        """Definitions of its constant arrays and sizes."""

    @abstractmethod
    def reference(self, features: Reals) -> Reals:
        """Force of each row of features (n, n_features), N, shape (n,)."""

    def manifest(self) -> JsonObject:
        """Its keys in the manifest."""
        return {}


@singledispatch
def feature_stage(features: Features, used: Columns, dt_s: float, dtype: RealType) -> FeatureStage:
    """Return the C of the columns `used` of some features; each kind registers its own."""
    raise TypeError(f"{type(features).__name__} has no stage: register one with feature_stage")


@singledispatch
def regressor_stage(
    regressor: Regressor, used: Columns, runtime: Runtime, dtype: RealType
) -> RegressorStage:
    """Return the C of a regressor on the columns `used`; each kind registers its own."""
    raise TypeError(f"{type(regressor).__name__} has no stage: register one with regressor_stage")


def select_vector_width(runtime: Runtime) -> int:
    """Numbers that tables are padded to whole vectors of; 1 where the target has no vectors."""
    return VECTOR_WIDTH if runtime.target == "host" else 1


def flush_denormal(x: Scalar) -> Scalar:
    """sp_flush_denormal: one number, or 0 where it would be near denormal."""
    return x.dtype.type(0) if abs(x) < x.dtype.type(SMALLEST) else x


def smooth_average(weight: Scalar, average: Scalar, newest: Scalar) -> Scalar:
    """sp_smooth: a moving average with the newest value in it."""
    return flush_denormal(average + weight * (newest - average))


def clamp_state(x: Scalar) -> Scalar:
    """sp_clamp_state: a state within +-LARGEST; what is no number becomes the largest."""
    largest = x.dtype.type(LARGEST)
    below = x if x < largest else largest
    return below if below > -largest else -largest


def round_up(n: int, vector_width: int = VECTOR_WIDTH) -> int:
    """Return n rounded up to whole vectors."""
    return -(-n // vector_width) * vector_width


def segments(length: int, starts: Starts) -> list[tuple[int, int, bool]]:
    """Stretches (begin, end, held) between restarts; before the first one nothing is held."""
    bounds = [0, *starts.tolist(), length]
    return [(begin, end, bool(i)) for i, (begin, end) in enumerate(pairwise(bounds)) if begin < end]


def pad_history(depth: Reals, starts: Starts, length: int) -> list[tuple[slice, Reals]]:
    """Return for each stretch between restarts its rows, and its samples with the past in front.

    (length + rows,), m. Before a stretch the object has rested at its first sample, before the
    first one at 0.
    """
    zero = depth.dtype.type(0)
    padded = []
    for begin, end, continues in segments(len(depth), starts):
        past = np.full(length, depth[begin] if continues else zero, dtype=depth.dtype)
        padded.append((slice(begin, end), np.concatenate([past, depth[begin:end]])))
    return padded


def stage_code(name: str) -> str:
    """Return the text of NAME.c.j2; its blocks are named in `Stage.code`."""
    template = files("springpot.codegen.stages") / "templates" / f"{name}.c.j2"
    return template.read_text(encoding="utf-8")
