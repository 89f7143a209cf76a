"""Kind `springpot`: a fractional solid, three or four numbers with intervals.

force = stiffness x + coefficient D^order x; where recordings show that this stops to grow at high
frequencies, a fractional Zener solid with a stiffness of an instant step besides. It is fitted and
rendered as a continuum of Maxwell branches with a spectrum in closed form (Cole and Cole, 1941):
trapezoids on log-spaced time constants converge exponentially, and no weight is below 0.
"""

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import nnls

from springpot.codegen.arrays import Flags, Indices, Samples
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.types import JsonObject
from springpot.trainer.features import highpass
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.quality.signs import compute_correlation
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import sensor_noise_n, smoothing_samples

_POLES_PER_DECADE, _MIN_TAU_STEPS, _MAX_TAU_PER_RECORDING = (
    2.5,
    0.25,
    10.0,
)  # time steps, longest recordings
_TAIL_LOG_SPAN, _TAIL_POINTS = (
    20.0,
    400,
)  # of ln tau beyond the branches: what is left further out is little
_MIN_UNITS, _BLOCKS = 4, 10  # fewer recordings are divided into blocks of rows
_ORDERS = np.linspace(0.02, 0.98, 49)
_ZENER_ORDERS = _ORDERS[_ORDERS < 0.71]  # nearer 1 it has but one time constant
_N_TIMES, _GRID_OFFSETS, _ZOOMS, _ORDER_SPACING, _TIME_SPACING = (
    25,
    np.arange(-3.0, 4.0),
    5,
    0.02,
    1.6,
)
_CONTACT_FRACTION, _NOISE_SIGMAS, _MIN_PULL_FRACTION = (
    0.01,
    4.0,
    0.002,
)  # of the peak force, of noise, of the samples
_MAX_ERROR_RATIO = 0.95  # of the error on what was left out: a fourth number has to be worth it
_MAX_CORRELATION = 0.3  # correlation of the residual: the share of its variance that is no noise
_ORDER_STEP, _SUM_TOLERANCE = 3e-4, 5e-4  # accuracy of the search, and of a sum of branches


@dataclass(frozen=True)
class Solid:
    """Stiffness at rest; weight of the fractional part, N s^order/m, or of a Zener solid N/m."""

    stiffness_npm: float
    weight: float
    order: float
    time_s: float | None

    def numbers(self) -> dict[str, float]:
        """The law; coefficient: of a Zener solid in slow motion, N s^order/m."""
        time_s = 1.0 if self.time_s is None else self.time_s
        law = {"stiffness_npm": self.stiffness_npm, "coefficient": self.weight * time_s**self.order}
        instant = {} if self.time_s is None else {"instant_npm": self.stiffness_npm + self.weight}
        return {**law, "order": self.order, **instant}

    def weights(self, tau_s: Samples) -> Samples:
        """Weights of depth and of each branch, (1 + n,), N/m."""
        weights = self.weight * compute_spectrum_weights(tau_s, self.order, self.time_s)
        weights[0] += self.stiffness_npm
        return weights


@dataclass(frozen=True, eq=False)
class _Table:
    """Rows of a set: depth, branches of tau_s, (n,), and force: (rows, 2 + n).

    means: what was taken off the columns where the mean force of a recording is free.
    unit: recording, or block of rows of few recordings, that is left out together, (rows,).
    """

    tau_s: Samples
    rows: Samples
    means: Samples
    unit: Indices

    def r_factor(self, chosen: Flags | slice = slice(None)) -> Samples:
        """Square root of the products of some rows: `root @ [weights, -1]` is what is missed."""
        return np.asarray(np.linalg.qr(self.rows[chosen], mode="r"))

    def residual_norm_n(self, solid: Solid, chosen: Flags | slice = slice(None)) -> float:
        return float(np.linalg.norm(self.rows[chosen] @ [*solid.weights(self.tau_s), -1.0]))


def fit_springpot(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the numbers by least squares; intervals by leaving out each recording in turn."""
    begin = time.perf_counter()
    rows = data.even_rows() if options.fraction is None else data.rows(options.fraction, 0)
    surface_set, contact_rows = _trace_surface(data, rows)
    table = _build_table(surface_set, contact_rows)
    simple, zener = (_fit_solid(table, table.r_factor(), is_zener) for is_zener in (False, True))
    (others, error), (zener_solids, zener_error) = (
        _jackknife(table, solid) for solid in (simple, zener)
    )
    solid, others = (
        (zener, zener_solids) if zener_error < _MAX_ERROR_RATIO * error else (simple, others)
    )
    bias_n = float(table.means[-1] - solid.weights(table.tau_s) @ table.means[:-1])
    passive = to_hammerstein(solid, table.tau_s, data)
    passive = replace(passive, bias_n=bias_n, recovers=surface_set is not data)
    smoothed = smoothing_samples(data.smooth_s, data.dt_s)
    lag = -(-smoothed * len(rows) // data.rows_total)
    metadata = _metadata(solid, others, table, lag)
    model = assemble(
        "springpot", name, data, options, len(contact_rows), (None, None), passive, True, metadata
    )
    return Fit(model, len(contact_rows), 0.0, time.perf_counter() - begin, metadata=metadata)


def _metadata(solid: Solid, others: Sequence[Solid], table: _Table, lag: int) -> JsonObject:
    """Provenance: each number and half its interval of 1.96 errors, 95 %; what the law misses.

    None in place of an interval if it misses alike in rows so far apart that they share no noise,
    or if the order is the lowest or highest that is searched: then another law fits better, as a
    Zener solid of order 0.14 that was fitted with 0.02, and intervals that left out each number.
    """
    law, missed_n = {}, table.rows @ [*solid.weights(table.tau_s), -1.0]
    autocorrelation = compute_correlation(missed_n[:-lag], missed_n[lag:])
    for name, value in solid.numbers().items():
        jackknife_values = np.array([other.numbers()[name] for other in others])
        squares = (len(others) - 1) * np.var(
            jackknife_values
        )  # the jackknife, Efron and Stein (1981)
        rounding = _ORDER_STEP if name == "order" else _SUM_TOLERANCE * abs(value)
        width = float(np.hypot(1.96 * np.sqrt(squares), rounding))
        law[name] = [value, width if autocorrelation < _MAX_CORRELATION else None]
    orders = _ORDERS if solid.time_s is None else _ZENER_ORDERS
    reach = max(law["order"][1] or 0.0, _ORDER_SPACING)
    if not orders[0] + reach < solid.order < orders[-1] - reach:
        law = {name: [value, None] for name, (value, _) in law.items()}
    force_norm_n = float(np.linalg.norm(table.rows[:, -1])) or 1.0
    percent = 100.0 * table.residual_norm_n(solid) / force_norm_n
    count = len(law) + bool(table.means.any())
    return {"n_parameters": count, "material": law, "residual_percent": percent}


def _build_table(data: TrainingSet, rows: Indices) -> _Table:
    """Evaluate spring and branches of all times once, as rows and columns of a linear fit.

    Branches from a quarter of a time step to ten times the longest recording.
    """
    fast_s, slow_s = _MIN_TAU_STEPS * data.dt_s, _MAX_TAU_PER_RECORDING * data.longest_s
    tau_s = np.geomspace(fast_s, slow_s, 2 + int(np.log10(slow_s / fast_s) * _POLES_PER_DECADE))

    def branches(depth_m: Samples, at: Indices) -> Samples:
        states_m = (highpass(depth_m, tau, data.dt_s)[at] for tau in tau_s.tolist())
        return np.stack([depth_m[at] - data.trained.min_m, *states_m], axis=1)

    table = np.column_stack([data.along(rows, branches), data.force_n(rows)])
    means = np.zeros(table.shape[1])
    owner, n_recordings = data.recording_index(rows), len(data.recordings)
    for in_recording in (owner == number for number in np.unique(owner)):
        if data.contact == "always":
            means += table[in_recording].mean(axis=0) / n_recordings
            table[in_recording] -= table[in_recording].mean(axis=0)
        table[in_recording] /= np.sqrt(in_recording.sum())
    unit = owner if n_recordings >= _MIN_UNITS else np.arange(len(rows)) * _BLOCKS // len(rows)
    return _Table(tau_s, table, means, unit)


def _trace_surface(data: TrainingSet, rows: Indices) -> tuple[TrainingSet, Indices]:
    """Return the set with the motion of its surface, and the rows in which the object pushes.

    It lets the tool go where the law, which is linear, would pull: it gives 0 N there, and its
    surface stays dented. The set and its rows as they are if that is seldom.
    """
    force_n = data.force_n(rows)
    noise_n = max(sensor_noise_n(recording.force_n) for recording in data.recordings)
    threshold_n = max(_CONTACT_FRACTION * float(force_n.max()), _NOISE_SIGMAS * noise_n)
    in_contact = force_n > threshold_n
    if data.contact == "always" or in_contact.all() or not in_contact.any():
        return data, rows
    surface_set, motions = data, data.motions
    for _ in range(3):
        table = _build_table(surface_set, rows[in_contact])
        law = to_hammerstein(_fit_solid(table, table.r_factor(), False), table.tau_s, data)
        if surface_set is data:
            unclipped_n = [
                simulate_passive(law, motion, data.dt_s, surface=False)[0] for motion in motions
            ]
            if float(np.mean(np.concatenate(unclipped_n) < -threshold_n)) < _MIN_PULL_FRACTION:
                return data, rows
        law = replace(law, recovers=True)
        depths_m = list(data.depths_m)
        for motion in motions:  # those of a session are one
            surface_m = simulate_passive(law, motion, data.dt_s, surface=True)[1]
            for number, start in zip(motion.recordings, motion.starts, strict=True):
                depths_m[number] = surface_m[start : start + len(depths_m[number])]
        surface_set = replace(data, depths_m=tuple(depths_m))
    return surface_set, rows[in_contact]


def to_hammerstein(solid: Solid, tau_s: Samples, data: TrainingSet) -> Hammerstein:
    """Return the same law as a spring and Maxwell branches: passive, and rendered by the same C."""
    span_m = data.trained.max_m - data.trained.min_m
    elastic_n, *branch_n = (span_m * solid.weights(tau_s)).tolist()
    is_used = np.array(branch_n) > 0.0
    return Hammerstein(
        origin_m=data.trained.min_m,
        span_m=span_m,
        elastic_n=np.array([elastic_n]),
        tau_s=tau_s[is_used],
        branch_n=np.array(branch_n)[is_used, None],
        radius_m=np.empty(0),
        stop_n=np.empty((0, 1)),
        bias_n=0.0,
    )


def compute_spectrum_weights(tau_s: Samples, order: float, time_s: float | None) -> Samples:
    """Return the weights of spring and branches, (1 + n,), that make a fractional element.

    The spring stands for what relaxes slower than all branches. tau_s: ascending, evenly spaced in
    their logarithm. time_s: T of the Zener solid, of weight 1 altogether, within 0.3 % for orders
    up to 0.7; None: of the derivative, s^-order.
    """
    log_tau, scale = np.log(tau_s), np.sin(np.pi * order) / np.pi
    reach = (log_tau[1] - log_tau[0]) / 2
    below = np.linspace(log_tau[0] - reach - _TAIL_LOG_SPAN, log_tau[0] - reach, _TAIL_POINTS)
    above = np.linspace(log_tau[-1] + reach, log_tau[-1] + reach + _TAIL_LOG_SPAN, _TAIL_POINTS)

    def spectrum(at: Samples) -> Samples:
        if time_s is None:
            return np.asarray(scale * np.exp(-order * at))
        far = np.clip(order * (at - np.log(time_s)), -300.0, 300.0)
        return np.asarray(scale / (2.0 * (np.cosh(far) + np.cos(np.pi * order))))

    if time_s is None:
        slow = spectrum(above)[0] / order
        fast_s = spectrum(below)[-1] * np.exp(below[-1]) / (1.0 - order)
    else:
        half, far = np.pi * order / 2.0, order * (above[0] - np.log(time_s))
        slow = (half - np.arctan(np.tan(half) * np.tanh(far / 2.0))) / (np.pi * order)
        fast_s = np.trapezoid(np.exp(below) * spectrum(below), below)
    weights = spectrum(log_tau) * 2 * reach
    # Faster branches follow the velocity, as a share of the fastest one here does; slower ones
    # relax at a rate, as a share of the slowest one does.
    weights[0] += fast_s / tau_s[0]
    relaxing = np.trapezoid(np.exp(-above) * spectrum(above), above) * tau_s[-1]
    weights[-1] += relaxing
    return np.concatenate([[slow - relaxing], weights])


def _search_grid(
    table: _Table, root: Samples, orders: Samples, times: Iterable[float | None]
) -> tuple[Solid, float]:
    """Return the best solid of some orders and times on a `_Table.root`, and its error, N^2."""
    solids: list[tuple[Solid, float]] = []
    for order, time_s in product(orders.tolist(), times):
        part = compute_spectrum_weights(table.tau_s, order, time_s)
        terms = np.stack([np.eye(1, len(part))[0], part], axis=1)
        weights, missed_n = nnls(root[:, :-1] @ terms, root[:, -1])
        solid = Solid(float(weights[0]), float(weights[1]), order, time_s)
        solids.append((solid, float(missed_n) ** 2))
    return min(solids, key=lambda pair: pair[1])


def _fit_solid(table: _Table, root: Samples, is_zener: bool, near: Solid | None = None) -> Solid:
    """Return the solid of lowest error: finer and finer grids about `near`, or the best of all."""
    orders, times = _ORDERS, [None]
    if is_zener:
        orders = _ZENER_ORDERS
        times = [*np.geomspace(table.tau_s[0], table.tau_s[-1], _N_TIMES).tolist()]
    near = near or _search_grid(table, root, orders, times)[0]
    for zoom in range(_ZOOMS):
        reach = _GRID_OFFSETS / 3.0**zoom
        around = np.clip(near.order + _ORDER_SPACING * reach, orders[0], orders[-1])
        if near.time_s is not None:
            around_s = np.clip(near.time_s * _TIME_SPACING**reach, table.tau_s[0], table.tau_s[-1])
            times = [*around_s.tolist()]
        near = _search_grid(table, root, around, times)[0]
    return near


def _jackknife(table: _Table, start: Solid) -> tuple[list[Solid], float]:
    """Fits without each unit, and the squares of their residuals on that unit, N^2."""
    solids, square = [], 0.0
    for unit in (table.unit == number for number in np.unique(table.unit)):
        solids.append(_fit_solid(table, table.r_factor(~unit), start.time_s is not None, start))
        square += table.residual_norm_n(solids[-1], unit) ** 2
    return solids, square
