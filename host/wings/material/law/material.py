"""What a material scientist reads from a fitted springpot: moduli, relaxation, Prony series."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import gamma

import numpy as np
from numpy.typing import NDArray

from springpot import Model, UsageError
from springpot.basics import Samples
from springpot.host.wings.material.law.fractional_solid import branches_for

_FINE = 0.01  # of the shortest time: time step of the branches of a relaxation
_CONFIDENCE = 1.96  # standard errors of a 95 % interval


@dataclass(frozen=True)
class Law:
    """Force of unit depth: stiffness + coefficient D^order, in N/m, N s^order/m.

    intervals: half widths of the 95 % intervals, under the same names; None if the recordings
    do not show a number, and not_identified says why. instant_npm: of a fractional Zener solid,
    the stiffness of an instant step; else None. residual_percent: what the law misses of the
    force that varies, rms. covered_hz: frequencies of the recordings; measured: what cyclic ones
    show by themselves. left_out: the law of all recordings but a part each, of which intervals are.
    """

    stiffness_npm: float
    coefficient: float
    order: float
    intervals: Mapping[str, float | None]
    instant_npm: float | None = None
    not_identified: Mapping[str, str] = field(default_factory=dict)
    residual_percent: float | None = None
    covered_hz: tuple[float, float] | None = None
    measured: Sequence[Mapping[str, float]] = ()
    left_out: "Sequence[Law]" = ()

    @property
    def time_s(self) -> float | None:
        """Relaxation time of a Zener solid; else T of the form k (1 + (T s)^order), s, None
        where there is no spring."""
        scale = self.stiffness_npm
        if self.instant_npm is not None:
            scale = self.instant_npm - self.stiffness_npm
        return float((self.coefficient / scale) ** (1.0 / self.order)) if scale > 0.0 else None

    def dynamic_npm(self, frequency_hz: Samples) -> NDArray[np.complex128]:
        """Return storage (real) and loss (imaginary) stiffness of a small sine, (n,), N/m."""
        part = self.coefficient * (2j * np.pi * np.asarray(frequency_hz)) ** self.order
        if self.instant_npm is not None:
            part = part / (1.0 + part / (self.instant_npm - self.stiffness_npm))
        return (self.stiffness_npm + part).astype(np.complex128)

    def dynamic_interval_npm(self, frequency_hz: Samples) -> tuple[Samples, Samples] | None:
        """Half widths of the 95 % intervals of storage and loss, (n,), N/m: by the jackknife.

        None if the recordings do not show the law.
        """
        if self.not_identified or not self.left_out:
            return None
        others = np.stack([other.dynamic_npm(frequency_hz) for other in self.left_out])
        return jackknife(others.real), jackknife(others.imag)

    def relaxing_npm(self, time_s: Samples) -> Samples:
        """Return force after a step of unit depth, (n,), N/m."""
        times = np.asarray(time_s, dtype=np.float64)
        if self.instant_npm is not None:
            assert self.time_s is not None
            branches = branches_for(_FINE * float(times.min()), float(times.max()))
            weights, slow = branches.weights(self.order, self.time_s)
            shares = np.exp(-times[:, None] / branches.tau_s) @ weights + slow
            zener: Samples = self.stiffness_npm + (self.instant_npm - self.stiffness_npm) * shares
            return zener
        falling: Samples = self.coefficient * times**-self.order / gamma(1.0 - self.order)
        return self.stiffness_npm + falling


@dataclass(frozen=True, eq=False)
class Prony:
    """The same law as the C has it: a spring and Maxwell branches, N/m, fast first.

    tau_s, branch_npm: (branches,).
    """

    long_term_npm: float
    tau_s: Samples
    branch_npm: Samples

    @property
    def instant_npm(self) -> float:
        """Stiffness of an instant step, N/m."""
        return self.long_term_npm + float(self.branch_npm.sum())

    def dynamic_npm(self, frequency_hz: Samples) -> NDArray[np.complex128]:
        """Return storage and loss stiffness as in `Law.dynamic_npm`, (n,), N/m."""
        s = 2j * np.pi * np.asarray(frequency_hz, dtype=np.float64)[:, None] * self.tau_s
        stiffness: NDArray[np.complex128] = self.long_term_npm + (
            self.branch_npm * s / (1.0 + s)
        ).sum(axis=1)
        return stiffness


def jackknife(values: Samples) -> Samples:
    """Half widths of the 95 % intervals, (...), of estimates that leave out a part each, (n, ...).

    Efron and Stein (1981).
    """
    n = len(values)
    squares = np.sum(np.square(values - values.mean(axis=0)), axis=0)
    half: Samples = _CONFIDENCE * np.sqrt((n - 1) / n * squares)
    return half


def law_of(model: Model) -> Law:
    """Return numbers of a model of kind springpot. Raises UsageError for other kinds."""
    if model.kind != "springpot" or "material" not in model.provenance:
        raise UsageError(
            f"{model.name}: a model of kind {model.kind} has no material law: train with "
            "--model springpot"
        )
    provenance = model.provenance
    material = {name: (found[0], found[1]) for name, found in provenance["material"].items()}
    value = {name: float(found[0]) for name, found in material.items()}
    covered = provenance.get("covered_hz")
    return Law(
        stiffness_npm=value["stiffness_npm"],
        coefficient=value["coefficient"],
        order=value["order"],
        intervals={name: found[1] for name, found in material.items()},
        instant_npm=value.get("instant_npm"),
        not_identified=provenance.get("not_identified", {}),
        residual_percent=provenance.get("residual_percent"),
        covered_hz=(covered[0], covered[1]) if covered else None,
        measured=provenance.get("measured", ()),
        left_out=tuple(
            Law(stiffness, coefficient, order, {}, instant_npm=instant)
            for stiffness, coefficient, order, instant in provenance.get("left_out", ())
        ),
    )


def prony_of(model: Model) -> Prony:
    """Return spring and branches of a springpot model. Raises UsageError for other kinds."""
    law_of(model)
    passive = model.hammerstein
    assert passive is not None
    order = np.argsort(passive.tau_s)
    return Prony(
        long_term_npm=float(passive.elastic_n[0] / passive.span_m),
        tau_s=passive.tau_s[order],
        branch_npm=passive.branch_n[order, 0] / passive.span_m,
    )
