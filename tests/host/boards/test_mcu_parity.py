"""One C on every board: 10 000 ticks, bit for bit what this machine gives."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.c.mcu import TICKS, long_motion, need, target_scene
from support.small import model_file, training

from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.model.model import Model
from springpot.host.emission.boards import BOARDS, CALL_IDLE, CALL_RESET, Batch, run_batch, steps
from springpot.host.emission.emission import emit
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

pytestmark = [pytest.mark.board, pytest.mark.slow]

KINDS = {
    "rf-fd": FitOptions(seed=1, trees=5, leaf=20),
    "rbf-fd": FitOptions(seed=1),
    "rbf-pv": FitOptions(seed=1),
    "hammerstein": FitOptions(seed=1),
}


@cache
def model(kind: str) -> Model:
    return fit_model(kind, "x", training(), KINDS[kind]).model


def assert_same(batch: Batch, force_n: np.ndarray, notes: np.ndarray) -> None:
    bits = f"u{force_n.dtype.itemsize}"
    assert np.sum(batch.force_n.view(bits) != force_n.view(bits)) == 0
    assert np.sum(batch.notes != notes) == 0


@pytest.mark.parametrize("mode", ["off", "tool", "proxy"])
@pytest.mark.parametrize("kind", list(KINDS))
def test_same_bits_on_every_board(tmp_path: Path, kind: str, mode: str) -> None:
    need(*BOARDS)
    chosen = target_scene("cortex-m4f", mode=mode)
    emit(chosen, model_file(tmp_path, model(kind)), tmp_path / "c", accept_unsafe=True)
    position = long_motion().astype(np.float32)
    velocity = backward_velocity(position, 1e-3)
    force_n, notes = Replay(SceneLibrary(tmp_path / "c")).run(position, velocity)
    assert np.ptp(force_n) > 1.0
    assert np.bitwise_or.reduce(notes) & 4, "the fallback outside was not visited"
    for board in BOARDS.values():
        batch = run_batch(tmp_path / "c", board, steps(position, velocity))
        assert len(batch.force_n) == TICKS
        assert_same(batch, force_n, notes)


@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("board", list(BOARDS))
def test_idle_reset_and_doubles_are_the_same_too(tmp_path: Path, board: str, number: str) -> None:
    need(board)
    chosen = target_scene(BOARDS[board].target, number=number, mode="tool", prefix="eco")
    emit(chosen, model_file(tmp_path, model("rf-fd")), tmp_path / "c", accept_unsafe=True)
    real = np.float32 if number == "float32" else np.float64
    position = long_motion()[:1500].astype(real)
    rows = steps(position, backward_velocity(position, 1e-3))
    rows["dt_s"], call = 1e-3, rows["call"]
    call[400:450] = CALL_IDLE  # longer than the watchdog waits
    call[600] = CALL_RESET
    if (board, number) != ("netduinoplus2", "float64"):  # its counter holds one tick of those
        call[700:705] = CALL_IDLE
    batch = run_batch(tmp_path / "c", BOARDS[board], rows)
    state, expected = SceneLibrary(tmp_path / "c").new_state(), []
    for i in range(1500):
        if call[i] & CALL_RESET:
            state.reset()
        made = state.idle(real(1e-3)) if call[i] & CALL_IDLE else state.step(position[i])
        expected.append(made)
    force_n = np.array([force for force, _ in expected], dtype=real)
    assert_same(batch, force_n, np.array([notes for _, notes in expected]))
    assert force_n[449] == 0 and force_n[599] == 0, "the watchdog did not latch"
    assert np.any(force_n[610:] > 0)
