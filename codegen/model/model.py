"""The model: all that the trainer hands on, and all that the C can need. Plain arrays, SI units."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from springpot.codegen.arrays import Samples, require
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.features import Features
from springpot.codegen.model.passive import Hammerstein, Start
from springpot.codegen.model.regressors import Regressor
from springpot.codegen.types import JsonMapping

Contact = Literal["surface", "always"]
# Of the depth: from here on a tool is inside the object. Above it all presses begin, which tells
# nothing of what came before.
_INSIDE_DEPTH_FRACTION = 0.002
# Times the fastest trained motion: what begins farther away than a tick of it has not come there in
# a tick.
_MAX_START_SPEED_RATIO = 4.0


@contextmanager
def _prefix_error(part: str) -> Iterator[None]:
    """Put a part's name before the field that an error names."""
    try:
        yield
    except DataError as error:
        raise DataError(f"{part}.{error}") from None


@dataclass(frozen=True)
class TrainedRange:
    """Extremes of the training recordings: what the guard needs to know."""

    min_m: float
    max_m: float
    max_mps: float
    min_n: float
    max_n: float

    def require_valid(self) -> None:
        """Raise DataError, with field and reason."""
        require(self.min_m <= self.max_m, "min_m: above max_m")
        require(self.min_n <= self.max_n, "min_n: above max_n")
        require(self.max_mps >= 0.0, f"max_mps: {self.max_mps:g} is negative")


@dataclass(frozen=True, eq=False)
class Model:
    """One fitted model: force = regressor(features), hammerstein, or their sum.

    kind: its name in the table of kinds ("rf-fd", ...).
    contact: "surface" where the recordings contain the contact, "always" where they never leave
    the object.
    hammerstein_adds: whether its force is part of the model's; else it is the fallback outside the
    trained depth.
    provenance: seed, rows, hashes of the training recordings, versions; JSON values.

    >>> train(recordings, "hammerstein").model.kind
    'hammerstein'
    """

    kind: str
    name: str
    dt_s: float
    contact: Contact
    trained: TrainedRange
    features: Features | None
    regressor: Regressor | None
    hammerstein: Hammerstein | None
    hammerstein_adds: bool
    provenance: JsonMapping = field(default_factory=dict)

    def __repr__(self) -> str:
        return (
            f"Model({self.name!r}, {self.kind}, {1.0 / self.dt_s:.6g} Hz, "
            f"to {1e3 * self.trained.max_m:.4g} mm and {self.trained.max_n:.4g} N)"
        )

    def require_valid(self) -> None:
        """Raise DataError, with part, field and reason, for what cannot be rendered."""
        features, regressor, passive = self.features, self.regressor, self.hammerstein
        require(self.dt_s > 0.0, f"dt_s: {self.dt_s:g} s is no time step")
        has_both_or_none = (features is None) != (regressor is None)
        require(not has_both_or_none, "features, regressor: one without the other")
        adds = passive is not None and self.hammerstein_adds
        require(adds or regressor is not None, "regressor, hammerstein: no force")
        require(adds == self.hammerstein_adds, "hammerstein_adds: nothing to add")
        has_places = passive is not None and passive.places is not None
        alone_at_a_surface = adds and regressor is None and self.contact == "surface"
        require(alone_at_a_surface or not has_places, "places: need a passive model with a surface")
        for name, part in (("trained", self.trained), ("features", features),
                           ("hammerstein", passive)):  # fmt: skip
            with _prefix_error(name):
                if part is not None:
                    part.require_valid()
        with _prefix_error("regressor"):
            if features is not None and regressor is not None:
                regressor.require_valid(features.n_features)

    @property
    def exact_at_any_rate(self) -> bool:
        """Tell if the features are the true ones at any sampling rate."""
        return self.features is None or self.features.exact_at_any_rate

    @property
    def engine(self) -> str:
        """Name the filter of the features' history: "fir", "fir-fast" or "recursive"."""
        return "recursive" if self.features is None else self.features.engine

    @property
    def orders(self) -> tuple[float, ...]:
        """Fractional orders of its features."""
        return () if self.features is None else self.features.fractional_orders

    @property
    def memory_s(self) -> float:
        """Return how far back the model remembers, s."""
        features_s = 0.0 if self.features is None else self.features.memory_s(self.dt_s)
        adds = self.hammerstein is not None and self.hammerstein_adds
        return max(features_s, self.hammerstein.memory_s if adds and self.hammerstein else 0.0)

    @property
    def has_state(self) -> bool:
        """Tell if training leaves a state that changes the force; features begin at rest."""
        return self.hammerstein is not None and self.hammerstein_adds

    @property
    def start_reach_m(self) -> float:
        """Return how far from where training ended a motion may begin that goes on, m."""
        return _MAX_START_SPEED_RATIO * self.trained.max_mps * self.dt_s

    def with_start(self, start: Start) -> "Model":
        """Return the model with this start. Raises UsageError for a state that it does not have."""
        passive = self.hammerstein
        if start == "auto" or passive is None:
            return self
        if start == "continues" and not self.has_state:
            raise UsageError(
                f"start {start!r}: {self.kind} keeps no state of its training presses: give "
                '"rested", or train --model hammerstein'
            )
        started = replace(passive, continues=start == "continues", end_depth_m=None)
        return replace(self, hammerstein=started)

    def continues_training(self, depth_m: Samples) -> bool:
        """Tell if a motion, (n,), m, goes on where the training recordings ended.

        Without a surface only from near there: elsewhere the object begins at rest.
        After a single one, which shows no start but its own: a motion that begins inside the
        object, within one of its own samples' steps of where that ended.
        """
        passive = self.hammerstein
        if passive is None or not self.has_state:
            return False
        if passive.end_depth_m is None:
            left_m = passive.origin_m + passive.span_m * passive.memory.u
            near = self.contact == "surface" or abs(depth_m[0] - left_m) <= self.start_reach_m
            return bool(passive.continues and near)
        step_m = float(np.abs(np.diff(depth_m)).max(initial=0.0))
        base_m = 0.0 if self.contact == "surface" else passive.origin_m
        inside = depth_m[0] - base_m > _INSIDE_DEPTH_FRACTION * passive.span_m
        return bool(inside and abs(depth_m[0] - passive.end_depth_m) <= step_m)

    def stiffened(self, factor: float) -> "Model":
        """Scale to an object so many times stiffer: the force at x is this one's at factor x.

        A power of two keeps every decision of a forest exactly; other factors move ties by
        rounding.
        """
        trained = self.trained
        features, scale = (None, 1.0) if self.features is None else self.features.stiffened(factor)
        return replace(
            self,
            trained=replace(
                trained,
                min_m=trained.min_m / factor,
                max_m=trained.max_m / factor,
                max_mps=trained.max_mps / factor,
            ),
            features=features,
            regressor=self.regressor and self.regressor.on_scaled(scale),
            hammerstein=self.hammerstein and self.hammerstein.stiffened(factor),
            provenance={**self.provenance, "stiffened": factor},
        )
