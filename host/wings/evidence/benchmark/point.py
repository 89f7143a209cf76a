"""A point of the benchmark: what is known of one model. Its fields are the keys of the JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any, Self

from springpot.basics import Number

Metadata = dict[str, Any]


@dataclass(frozen=True)
class Sizes:
    """Bytes on the target; None if unknown, and why.

    sizes_compiler: version of the target's compiler that they are of; None if there is none.
    """

    flash_bytes: int | None = None
    stack_bytes: int | None = None
    why: str | None = None
    sizes_compiler: str | None = None


@dataclass(frozen=True)
class Isolated:
    """What is measured of the front and the picks alone on the machine; None of other points.

    tick_ns_*: paced, caches cold. bounded: in the closed loop with every hand. instructions: of
    the longest tick on the target's board; instructions_why: how they were counted, or why not.
    """

    tick_ns_p50: float | None = None
    tick_ns_p99: float | None = None
    tick_ns_p999: float | None = None
    tick_ns_max: float | None = None
    bounded: bool | None = None
    instructions: int | None = None
    instructions_why: str | None = None
    spectral_radius: float | None = None
    coupling: str | None = None
    worst_fidelity_percent: float | None = None
    verdict: str | None = None


@dataclass(frozen=True, kw_only=True)
class Point(Isolated, Sizes):
    """One model: how it was fitted, its errors, times and sizes.

    options: those that are not the default's. cv_rmse_n: cross-validated on the training
    recordings; rmse_n to ape_below_jnd: of the C on the validation recordings. tick_ns_hot: median
    in a tight loop. cells: of the small-signal map; active ones are not passive.
    n_nodes to law: size of the model, those that its kind has.
    """

    key: str
    model: str
    options: Mapping[str, Any]
    number: Number
    engine: str
    window_s: float
    orders: Sequence[float]
    any_rate: bool
    rows: int
    feature_s: float
    fit_s: float
    search_s: float
    hash: str
    cv_rmse_n: float
    rmse_n: float
    rmse_percent_of_peak: float
    mean_recording_rmse_n: float
    mean_recording_rmse_interval_n: Sequence[float] | None
    p99_abs_error_n: float
    max_abs_error_n: float
    ape_below_jnd: float | None
    tick_ns_hot: float
    ram_bytes: int
    left_out: Sequence[Mapping[str, Any]]
    active_cells: int
    cells: int
    active_cells_outside: int
    cells_outside: int
    worst_sin_delta: float
    point_s: float
    point_cpu_s: float
    worker: str
    error_per_jnd: float | None = None
    slope_error_median_percent: float | None = None
    slope_error_p95_percent: float | None = None
    slope_floor_percent: float | None = None
    n_nodes: int | None = None
    n_centers: int | None = None
    n_parameters: int | None = None
    pairs: Any = None
    law: str | None = None
    pareto: bool = False

    @classmethod
    def from_dict(cls, metadata: Mapping[str, Any]) -> Self:
        """Read JSON values; None if a condensed file has left one out."""
        empty = {f.name: None if f.default is MISSING else f.default for f in fields(cls)}
        return cls(**{name: metadata.get(name, value) for name, value in empty.items()})

    def swept(self) -> dict[str, Any]:
        """Return JSON values of what the sweep measures."""
        own = {name: value for name, value in vars(self).items() if name not in _LATER}
        return {k: v for k, v in own.items() if v is not None or k not in MODEL_SIZES}

    def as_dict(self) -> dict[str, Any]:
        """Return JSON values of all."""
        return self.swept() | {name: getattr(self, name) for name in _LATER}


@dataclass(frozen=True)
class Refused:
    """A model that could not be made of these recordings, and why."""

    key: str
    model: str
    options: Mapping[str, Any]
    error: str

    def swept(self) -> dict[str, Any]:
        return dict(vars(self))


MODEL_SIZES = ("n_nodes", "n_centers", "n_parameters", "pairs", "law")
_LATER = ("pareto", *(field.name for field in fields(Isolated)))


def read_point(metadata: Mapping[str, Any]) -> Point | Refused:
    """Return a point of JSON values."""
    return Refused(**metadata) if "error" in metadata else Point.from_dict(metadata)


def points_of(result: Mapping[str, Any]) -> list[Point]:
    """Return all points of a benchmark's result."""
    return [Point.from_dict(metadata) for metadata in result["points"]]
