"""The C API of an emitted scene: misuse, silence, reset, and what a session does to it."""

import dataclasses
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support.small import model_file, passive_model, press, recording, scene

from springpot.codegen.notes import HELD, LATCHED, RAMPED, RESYNC
from springpot.host.emission.emission import emit
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

DT_S = 1e-3
NULL, TIME_STEP = -1, -2


def library(folder: Path, contact: str = "surface", **options: str) -> SceneLibrary:
    model = dataclasses.replace(passive_model(), contact=contact)
    emit(scene(**options), model_file(folder, model), folder / "c")
    return SceneLibrary(folder / "c")


def test_null_pointers_are_misuse_and_change_nothing(tmp_path: Path) -> None:
    lib = library(tmp_path)
    ffi = lib.loaded.ffi
    state = lib.loaded.memory(lib.state_bytes, "sp_state")
    lib.function("init")(state)
    force = ffi.new("float[1]", [7.0])
    assert lib.function("step")(ffi.NULL, 0.0, 0.0, force) == NULL
    assert lib.function("step")(state, 0.0, 0.0, ffi.NULL) == NULL
    assert lib.function("run")(state, 1, ffi.NULL, ffi.NULL, force) == NULL
    assert lib.function("idle")(ffi.NULL, 0.001, force) == NULL
    for dt_s in (0.0, -1.0, float("nan"), float("inf")):
        assert lib.function("idle")(state, dt_s, force) == TIME_STEP
    assert force[0] == 7.0
    lib.function("init")(ffi.NULL)
    lib.function("reset")(ffi.NULL)


def test_silence_takes_the_force_to_zero_and_latches_until_reset(tmp_path: Path) -> None:
    state = library(tmp_path).new_state()
    forces, _ = state.run(press(1.0)[:500])
    pressed_n = float(forces[-1])
    assert pressed_n > 1.0
    silent = [state.idle(DT_S) for _ in range(60)]
    held = [force for force, notes in silent if notes == HELD]
    falling = [force for force, notes in silent if notes == LATCHED]
    assert len(held) == pytest.approx(20, abs=1)
    # It goes on as it last changed, less and less: ten times that change at most.
    last_n = abs(pressed_n - float(forces[-2]))
    assert np.abs(np.array(held) - pressed_n).max() <= 10.0 * last_n + 1e-6
    assert falling[10:] == [0.0] * len(falling[10:])
    assert all(before >= after for before, after in pairwise(falling))
    force_n, notes = state.step(0.0119)
    assert force_n == 0.0 and notes & LATCHED
    state.reset()
    first_n, notes = state.step(0.006)
    assert (first_n, notes) == (0.0, RESYNC | RAMPED)
    later = [state.step(0.006)[0] for _ in range(60)]
    assert later[0] < 0.2 * later[-1] < later[-1]


def test_no_force_above_the_surface_even_while_falling(tmp_path: Path) -> None:
    state = library(tmp_path).new_state()
    state.run(press(1.0)[:500])
    for _ in range(22):
        state.idle(DT_S)
    for _ in range(8):
        state.step(0.0)
    assert state.step(-0.001)[0] == 0.0
    state.reset()
    assert state.run([0.001, np.nan, 0.001])[1] & HELD  # what any of its ticks noted


def test_without_a_surface_there_is_no_force_before_a_sample(tmp_path: Path) -> None:
    state = library(tmp_path, contact="always").new_state()
    assert {state.step(float("nan"))[0] for _ in range(15)} == {0.0}


@pytest.mark.slow
def test_a_lasting_jump_is_taken_as_true_before_the_watchdog_latches(tmp_path: Path) -> None:
    item = recording("slow", press(0.5)[::10])
    slow = [dataclasses.replace(item, force_n=300.0 * item.position_m, dt_s=0.01)]
    model = fit_model("rf-fd", "slow", slow, FitOptions(trees=3, leaf=5)).model
    # No hand could hold it at 100 Hz: for replay.
    emit(scene(), model_file(tmp_path, model), tmp_path / "c", accept_unsafe=True)
    state = SceneLibrary(tmp_path / "c").new_state()
    for _ in range(20):
        state.step(0.001)
    notes = [state.step(0.05)[1] for _ in range(20)]
    assert any(note & RESYNC for note in notes) and not any(note & LATCHED for note in notes)
