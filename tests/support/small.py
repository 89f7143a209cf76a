"""Small models and motions for the tests: made in a fraction of a second, always the same."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import write_model
from springpot.codegen.model.passive import Damage, Flow, Hammerstein
from springpot.codegen.model.regressors import OPERATIONS, Expression
from springpot.codegen.scene import Coupling, Runtime, Scene, Smoothing
from springpot.trainer.features import gl_taps
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.passive.passive_force import simulate_passive
from springpot.trainer.recordings.recording import Recording, Zero
from support.derivatives import fir_derivatives

DT_S = 1e-3
DEPTH_M = 0.012


def press(frequency_hz: float, depth_m: float = DEPTH_M, cycles: int = 1) -> np.ndarray:
    time_s = np.arange(round(cycles / frequency_hz / DT_S)) * DT_S
    return depth_m / 2 * (1 - np.cos(2 * np.pi * frequency_hz * time_s))


def soft_force(position_m: np.ndarray) -> np.ndarray:
    """A stiffening object with a springpot: nothing that a window of 171 taps holds exactly."""
    depth_m = np.maximum(position_m, 0.0)
    lossy = fir_derivatives(depth_m, gl_taps(0.2, 600, DT_S)[:, None])[:, 0]
    return np.maximum(0.0, 250.0 * depth_m + 4e4 * depth_m**2 + 25.0 * lossy)


def recording(name: str, position_m: np.ndarray, zero: Zero = "none") -> Recording:
    return Recording(name, position_m, soft_force(position_m), DT_S, zero=zero)


@cache
def training() -> tuple[Recording, ...]:
    return tuple(
        recording(f"{share}-{frequency_hz}", press(frequency_hz, share * DEPTH_M))
        for share in (0.3, 0.7, 1.0)
        for frequency_hz in (0.5, 1.0, 3.0, 5.0)
    )


# Every part of a model: its kind, and options beside those of `fitted`.
VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "rf-fd": ("rf-fd", {}),
    "rbf-fd": ("rbf-fd", {}),
    "hammerstein": ("hammerstein", {}),
    "rbf-fd-fast": ("rbf-fd", {"engine": "fir-fast"}),
    "rbf-pv": ("rbf-pv", {}),
    "rbf-pv-averaged": ("rbf-pv", {"velocity_weight": 0.7}),
    "rf-fd-fast": ("rf-fd", {"engine": "fir-fast"}),
    "rf-fd-fast-quantised": ("rf-fd", {"engine": "fir-fast", "round_features": True}),
    "rf-fd-long": ("rf-fd", {"window_s": 2.0}),
    "rf-fd-long-quantised": ("rf-fd", {"window_s": 2.0, "round_features": True}),
    "rf-fd-quantised": ("rf-fd", {"round_features": True}),
    "rf-history": ("rf-fd", {"past_positions": True}),
    "rf-history-quantised": ("rf-fd", {"past_positions": True, "round_features": True}),
    "springpot": ("springpot", {}),
}


@cache
def fitted(variant: str, **options: Any) -> Model:
    """Fit one of VARIANTS; options: in place of its own."""
    kind, own = VARIANTS[variant]
    asked = FitOptions(**{"trees": 5, "leaf": 20, **own, **options})
    return fit_model(kind, variant, training(), asked).model


@cache
def small_fit(trees: int = 5) -> Fit:
    return fit_model("rf-fd", "small", training(), FitOptions(seed=1, trees=trees, leaf=20))


def small_model() -> Model:
    """A forest, the kind with most C: a second of the compiler."""
    return _at_rest(small_fit().model)


def written_model() -> Model:
    """A regressor that m2cgen writes: N exp(x^2), and 1 or 2 N by x."""
    names = [
        "FeatureRef",
        "NumVal",
        "PowExpr",
        "ExpExpr",
        "FeatureRef",
        "NumVal",
        "LTE",
        "NumVal",
        "NumVal",
        "IfExpr",
    ]
    operand = np.array([0, 2.0, 0, 0, 1, 0.2, 0, 1.0, 2.0, 0])
    operation = np.array([list(OPERATIONS).index(name) for name in names], np.int32)
    inputs = np.array([1, 3], np.int32), np.zeros(2), np.full(2, 50.0)
    return replace(small_model(), regressor=Expression(operation, operand, *inputs))


@cache
def passive_model() -> Model:
    """A spring with a memory, the kind with least C: for what any model shows."""
    return _at_rest(fit_model("hammerstein", "small", training(), FitOptions(seed=1)).model)


def _at_rest(model: Model) -> Model:
    """Without a memory, so that tests can change its branches."""
    assert model.hammerstein is not None
    return replace(model, hammerstein=replace(model.hammerstein, end_memory=None))


def scene(
    number: str = "float32",
    mode: str = "off",
    smoothing_s: float = 0.0,
    prefix: str = "sp",
) -> Scene:
    return Scene(
        schema=1,
        name="test",
        model="model.spm",
        runtime=Runtime(number=number, prefix=prefix),  # type: ignore[arg-type]
        coupling=Coupling(mode=mode),  # type: ignore[arg-type]
        smoothing=Smoothing(time_constant_s=smoothing_s),
    )


def model_file(folder: Path, model: Model | None = None) -> Path:
    path = folder / "model.spm"
    write_model(path, model or passive_model())
    return path


def wandering(seed: int, ticks: int = 4000) -> np.ndarray:
    """A hand's motion in and out of the object, deeper than trained, with what devices do wrong."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(0.0, 1.2e-4, ticks)
    position_m = np.convolve(np.cumsum(steps), np.ones(20) / 20, mode="same")
    position_m += 0.3 * DEPTH_M - position_m[0]
    bad = rng.integers(0, ticks, 24)
    position_m[bad[:6]] = np.nan
    position_m[bad[6:9]] = np.inf
    position_m[bad[9:14]] += rng.normal(0.0, 1.0, 5)
    position_m[bad[14] :] += 0.01  # a jump that stays: the guard resynchronises
    position_m[bad[15] : bad[15] + 30] = np.nan  # longer than the watchdog waits
    position_m[bad[16]] = 1e30
    position_m[bad[17]] = 1e-42
    return position_m


def flow(force_n: float) -> Flow:
    """Two branches that flow, of either power."""
    return Flow(np.array([50.0, 2e3]), np.array([3, 5]), np.array([1, 4]), np.full(2, force_n))


def damage(curve_n: np.ndarray) -> Damage:
    """Either power, and either kind of healing; curve_n: slopes of one curve."""
    curves_n = np.outer([0.3, 0.1, 0.2, 0.1], curve_n)
    return Damage(np.array([0.0, 0.0, 5.0, 5.0]), np.array([1, 3, 1, 3]), curves_n)


def passive_force_n(
    model: Hammerstein, depth_m: np.ndarray, dt_s: float, surface: bool
) -> np.ndarray:
    """Force of a passive model along depths, (n,), N, from rest at the first one."""
    return simulate_passive(model, DepthMotion(depth_m, (0,), (0,)), dt_s, surface)[0]
