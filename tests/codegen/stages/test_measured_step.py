"""Poles over a measured time step: true to the derivative at any rate, with jitter and stalls."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import cffi
import numpy as np
import pytest
from support.c.caputo import caputo_derivative
from support.paths import C_TESTS
from support.small import DT_S, model_file, press, scene, small_model, training

from springpot import Coupling, FitOptions, Model, Runtime
from springpot.codegen.stages.recursive import SLOW_TICKS
from springpot.emission import LATCHED
from springpot.host.emission.emission import emit
from springpot.host.native.compiler import shared_library
from springpot.modelling import fit_model, recursive_bank
from springpot.native import INCLUDE, SOURCE, CLibrary, SceneLibrary
from springpot.trainer.models.rf_fd import PAPER_ORDERS, RECURSIVE_S

HARNESS = C_TESTS / "measured_harness.c"
FINE_S = 1e-4
SECONDS = 12.0
TIME_STEP_ERROR = -2


def harness(real: str) -> tuple[cffi.FFI, Any]:
    declarations = (
        f"void phis(const {real} *, uint32_t, {real} *);"
        f"void measured_poles(const {real} *, uint32_t, uint32_t, uint32_t, const {real} *,"
        f" const {real} *, double *, {real} *);"
    )
    loaded = CLibrary(shared_library([HARNESS], [SOURCE, INCLUDE / real]), declarations)
    return loaded.ffi, loaded.c


@pytest.mark.parametrize(("real", "dtype"), [("float", np.float32), ("double", np.float64)])
def test_phi_is_within_its_stated_error(real: str, dtype: type) -> None:
    ffi, library = harness(real)
    u = np.concatenate([[0.0], np.geomspace(1e-12, 1e9, 30_000)]).astype(dtype)
    phi = np.empty_like(u)
    library.phis(ffi.from_buffer(f"{real}[]", u), len(u), ffi.from_buffer(f"{real}[]", phi))
    wide = u.astype(np.float64)
    exact = np.divide(-np.expm1(-wide), wide, out=np.ones_like(wide), where=wide > 0)
    error = np.abs(phi - exact) / exact
    assert error.max() < (3e-6 if dtype is np.float32 else 1e-7)
    # what a pole loses in a step is never more than it holds
    assert (u * phi).max() < 1 + error.max()


@cache
def fine_motion() -> tuple[np.ndarray, np.ndarray, dict[float, np.ndarray]]:
    """Time, depth with motion up to 5 Hz, and its derivatives of some orders."""
    t = np.arange(round(SECONDS / FINE_S)) * FINE_S
    turns = 2 * np.pi * np.outer([0.2, 0.7, 1.9, 5.0], t) + np.arange(4)[:, None]
    depth = 0.006 + 0.001 * np.sin(turns).sum(axis=0)
    rest = depth - depth[0]
    return t, depth, {r: caputo_derivative(rest, r, FINE_S) for r in (0.05, 0.25, 0.5)}


def jittered(dt_s: float, share: float, stalls: bool) -> np.ndarray:
    rng = np.random.default_rng(4)
    steps = dt_s * (1.0 + share * rng.uniform(-1.0, 1.0, round(SECONDS / dt_s)))
    if stalls:
        steps[:: len(steps) // 20] = 0.010
    times = np.concatenate([[0.0], np.cumsum(steps)])
    return times[times < SECONDS - FINE_S]


@pytest.mark.parametrize(
    ("dt_s", "share", "stalls"),
    [(0.25e-3, 0.0, False), (1.27e-3, 0.0, False), (2e-3, 0.0, False), (1e-3, 0.3, False),
     (1e-3, 0.3, True)],
)  # fmt: skip
def test_features_stay_true_at_any_rate(dt_s: float, share: float, stalls: bool) -> None:
    bank = recursive_bank(PAPER_ORDERS, DT_S, RECURSIVE_S)
    fine_s, fine_depth, derivatives = fine_motion()
    times = jittered(dt_s, share, stalls)
    depth = np.interp(times, fine_s, fine_depth).astype(np.float32)
    steps = np.diff(times, prepend=0.0).astype(np.float32)
    states = np.zeros((len(times), len(bank.tau_s)), dtype=np.float32)
    n_fast = int(np.sum(bank.tau_s <= SLOW_TICKS * DT_S))
    slow = np.zeros(len(bank.tau_s) - n_fast)
    ffi, library = harness("float")
    pointers = [ffi.from_buffer("float[]", values) for values in (steps, depth)]
    library.measured_poles(
        ffi.from_buffer("float[]", (1.0 / bank.tau_s).astype(np.float32)), len(bank.tau_s), n_fast,
        len(times), *pointers, ffi.from_buffer("double[]", slow),
        ffi.from_buffer("float[]", states),
    )  # fmt: skip
    for order, exact in derivatives.items():
        found = states.astype(np.float64) @ bank.weights[:, bank.orders.index(order)]
        wanted = np.interp(times, fine_s, exact)
        settled = times > 0.2
        error = np.sqrt(np.mean((found - wanted)[settled] ** 2) / np.mean(wanted[settled] ** 2))
        assert error < 3e-3, order


@cache
def fitted(kind: str) -> Model:
    options = FitOptions(trees=5, leaf=20, engine="recursive" if kind != "hammerstein" else None)
    return fit_model(kind, "x", training(), options).model


def built(folder: Path, model: Model) -> SceneLibrary:
    emit(scene(), model_file(folder, model), folder / "c")
    return SceneLibrary(folder / "c")


def run_dt(library: SceneLibrary, depth: np.ndarray, steps: np.ndarray) -> np.ndarray:
    state = library.new_state()
    return np.array([state.step_dt(dt, x)[0] for dt, x in zip(steps, depth, strict=True)])


@pytest.mark.parametrize("kind", ["hammerstein", "boosted"])
def test_the_planned_step_measured_is_the_planned_step(tmp_path: Path, kind: str) -> None:
    library = built(tmp_path, fitted(kind))
    depth = press(2.0)
    planned, _ = library.new_state().run(depth)
    measured = run_dt(library, depth, np.full(len(depth), DT_S))
    assert np.ptp(planned) > 1.0
    # Trees see features that differ in their last bits: a few leaves are others.
    off = np.abs(measured - planned) / np.ptp(planned)
    assert np.quantile(off, 0.99) < (1e-5 if kind == "hammerstein" else 1e-3)


def test_a_late_tick_gives_the_force_of_its_time(tmp_path: Path) -> None:
    library = built(tmp_path, fitted("hammerstein"))
    rng = np.random.default_rng(1)
    steps = np.full(4000, DT_S / 4.0)
    steps[1000:] *= rng.uniform(0.1, 4.0, 3000)
    times = np.cumsum(steps)
    depth = 0.005 * (1.0 - np.cos(2 * np.pi * 2.0 * times))
    fine = np.arange(0.0, times[-1], DT_S / 20.0)
    exact = run_dt(library, 0.005 * (1.0 - np.cos(4 * np.pi * fine)), np.full(len(fine), DT_S / 20))
    found = run_dt(library, depth, steps)
    wanted = np.interp(times, fine, exact)
    settled = times > 0.1
    assert np.abs(found - wanted)[settled].max() < 0.01 * np.ptp(exact)


@pytest.mark.parametrize("dt_s", [0.0, -1e-3, np.nan, np.inf])
def test_a_time_step_out_of_bounds_changes_nothing(tmp_path: Path, dt_s: float) -> None:
    library = built(tmp_path, fitted("hammerstein"))
    state = library.new_state()
    for x in press(2.0)[:200]:
        state.step(x)
    before = state.step(0.004)[0]
    assert library.function("step_dt")(state._state, dt_s, 0.005, 0.0, state._force) == (
        TIME_STEP_ERROR
    )
    assert state._force[0] == before


@pytest.mark.parametrize("dt_s", [0.03, 0.9, 1.5, 1e9])
def test_a_long_time_step_is_silence_before_the_sample(tmp_path: Path, dt_s: float) -> None:
    library = built(tmp_path, fitted("hammerstein"))
    state = library.new_state()
    for x in press(2.0)[:60]:
        state.step_dt(DT_S, x)
    force_n, notes = state.step_dt(dt_s, 0.011)
    assert notes & LATCHED
    assert force_n == 0.0
    assert state.step_dt(DT_S, 0.011) == (0.0, LATCHED)


def test_a_scene_of_one_rate_has_no_measured_step(tmp_path: Path) -> None:
    asked = replace(scene(), runtime=Runtime(measured_step=True))
    emission = emit(asked, model_file(tmp_path, small_model()), tmp_path / "c")
    assert "step_dt" not in (tmp_path / "c" / "sp.h").read_text()
    assert not (tmp_path / "c" / "sp_measured.h").exists()
    assert any("no sp_step_dt" in line for line in emission.notices)
    coupled = replace(asked, coupling=Coupling(mode="proxy"))
    notices = emit(coupled, model_file(tmp_path), tmp_path / "d").notices
    assert any("no sp_step_dt is emitted, for the coupling" in line for line in notices)


@pytest.mark.parametrize("longest_s", [20.0, 1000.0])
@pytest.mark.parametrize("dt_s", [1e-3, 0.01, 0.1])
def test_exponentials_exist_for_every_order_and_are_true_to_it(longest_s, dt_s):
    orders = (0.02, 0.35, 0.66, 0.75, 0.85, 0.95, 0.999)
    bank = recursive_bank(orders, dt_s, longest_s)
    assert np.all(bank.weights >= 0)
    omega = np.geomspace(2 * np.pi / longest_s * 4, 2 * np.pi * 0.05 / dt_s, 100)
    s = 1j * omega[:, None]
    found = (s / (s + 1 / bank.tau_s)) @ bank.weights / s ** np.array(orders)
    assert np.all(np.abs(found - 1).max(axis=0) < (0.02, 0.02, 0.02, 0.02, 0.02, 0.04, 0.1))
