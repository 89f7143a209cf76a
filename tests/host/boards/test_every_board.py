"""One C on every board, bit for bit what this machine gives, and its size and time there."""

import dataclasses
import json
import re
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.c.mcu import TICKS, long_motion, need, target_scene
from support.in_process import spring
from support.small import damage, fitted, flow, model_file, passive_model, press, recording

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Memory
from springpot.codegen.model.regressors import Linear
from springpot.codegen.notes import HELD, RESYNC
from springpot.host.emission.boards import BOARDS, CALL_IDLE, CALL_RESET, Batch, run_batch, steps
from springpot.host.emission.emission import emit, read_emission
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.trainer.recordings.hdf5_file import write_recording

pytestmark = [pytest.mark.board, pytest.mark.slow]

PLAIN = ("rf-fd", "rf-fd-fast-quantised", "rf-fd-long", "rf-history", "rbf-fd", "rbf-fd-fast",
         "rbf-pv", "rbf-pv-averaged", "hammerstein", "springpot")  # fmt: skip
CHANGED = {
    "rf-fd deep": ("rf-fd", {"trees": 8, "leaf": 1}),
    "rf-fd rounded": ("rf-fd-quantised", {"trees": 20, "leaf": 5}),
    "rf-fd few orders": ("rf-fd-fast", {"orders": (0.1, 0.2)}),
}
# What no fit of these recordings chooses.
OF_DEPTH = {
    "rates by depth": {"n_by_depth": 4, "rate_ratio": 16.0},
    "flow": {"flow": flow(4.0), "recovers": True},
    "damage": {"n_by_depth": 8, "rate_ratio": 1 / 16, "damage": damage(np.ones(9))},
}
PRESSED = Memory(
    np.full(8, -0.01), *np.zeros((2, 0)), play=np.array([0.1, 0.3]), u=0.5, force_n=0.1
)
MEMORY = {"end_memory": PRESSED, "continues": True}
OF_DEPTH["continues"] = OF_DEPTH["rates by depth"] | MEMORY
SHAPES = {"off": {}, "tool": {"mode": "tool", "smoothing_s": 1e-3}, "proxy": {"mode": "proxy"}}

FIRST = [("rf-fd", "proxy"), ("hammerstein", "tool"), ("rbf-pv", "proxy"), ("rf-fd deep", "off"),
         ("flow", "off"), ("damage", "off"), ("continues", "off"), ("linear", "off")]  # fmt: skip
CASES = dict.fromkeys([
    *FIRST,
    *((variant, "off") for variant in (*PLAIN, *CHANGED, *OF_DEPTH)),
    *product(("rf-fd", "hammerstein", "rbf-fd", "rbf-pv"), ("tool", "proxy")),
])  # fmt: skip


def model_of(variant: str) -> Model:
    if variant in OF_DEPTH:
        return passive_of(branches=8, stops=2, **OF_DEPTH[variant])
    if variant == "linear":
        return dataclasses.replace(fitted("rf-fd"), regressor=Linear(0.5, np.linspace(-1, 2, 10)))
    like, options = CHANGED.get(variant, (variant, {}))
    return fitted(like, seed=1, **options)


def passive_of(branches: int, stops: int, **of_depth: Any) -> Model:
    """A passive model of so many branches and stops."""
    rng, whole = np.random.default_rng(1), passive_model()
    passive = dataclasses.replace(
        whole.hammerstein,
        elastic_n=rng.random(9),
        tau_s=np.geomspace(2e-3, 5.0, branches),
        branch_n=rng.random((branches, 9)),
        radius_m=np.array([0.02, 0.2, 0.5])[:stops] * whole.hammerstein.span_m,
        stop_n=rng.random((stops, 9)),
        **{"end_memory": None, **of_depth},
    )
    return dataclasses.replace(whole, hammerstein=passive)


def after_silence(notes: np.ndarray) -> np.ndarray:
    """Ticks, (n,), that make up for some without a sample."""
    held = (notes & HELD) != 0
    return ((notes & RESYNC) == 0) & ~held & np.concatenate([[False], held[:-1]])


@pytest.mark.parametrize(("variant", "number"), [("rf-fd", "float32"), ("rbf-pv", "float64")])
def test_the_boards_have_one_c(variant: str, number: str) -> None:
    def parts(target: str) -> dict[str, str]:
        plan = make_plan(model_of(variant), target_scene(target, number=number, mode="proxy"), True)
        files = emit_files(plan)
        files.pop("manifest.json")
        return {name: re.sub("[0-9a-f]{64}", "", text) for name, text in files.items()}

    first = parts("cortex-m4f")
    for target in ("cortex-m7", "rv32imafc"):
        assert parts(target) == first, target


def test_ten_branches_and_three_stops_take_640_instructions_and_4400_bytes(tmp_path: Path) -> None:
    need("mps2-an386")
    # A surface that recovers takes 64 and 396 more.
    model = model_file(tmp_path, passive_of(branches=10, stops=3, recovers=False))
    chosen = target_scene("cortex-m4f")
    emission = emit(chosen, model, tmp_path / "c", accept_unsafe=True)
    position = long_motion().astype(np.float32)
    calls = steps(position, differentiate(position, 1e-3))
    batch = run_batch(
        tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS["mps2-an386"], calls
    )
    restarts = (batch.notes & RESYNC) != 0
    most = int(batch.instructions[~restarts & ~after_silence(batch.notes)].max())
    assert most <= 640 and emission.footprint.flash_bytes <= 4400
    assert 0.9 * most <= emission.cost.usual <= 640
    assert 10 * most < emission.cost.after_silence < 20 * most  # each missed tick


def test_a_forest_is_not_walked_for_missed_ticks(tmp_path: Path) -> None:
    """Without a coupling nobody needs its force there."""
    need("mps2-an386")
    chosen = target_scene("cortex-m4f", mode="off")
    cost = emit(chosen, model_of("rf-fd deep"), tmp_path / "c", accept_unsafe=True).cost
    assert cost.why == "emulated mps2-an386" and cost.after_silence < 6 * cost.usual


def test_a_pc_has_no_emulated_board(tmp_path: Path) -> None:
    cost = emit(target_scene("host"), model_file(tmp_path), tmp_path / "c").cost
    assert (cost.usual, cost.after_silence) == (None, None) and "target" in cost.why


def test_fit_makes_it_fit(tmp_path: Path) -> None:
    need("mps2-an386")
    model_file(tmp_path, model_of("rf-fd deep"))
    recorded, folder = tmp_path / "val.h5", tmp_path / "c"
    write_recording(recorded, recording("val", press(1.5, 0.011, cycles=3)))
    (tmp_path / "scene.toml").write_text(
        'schema = 1\nname = "big"\nmodel = "model.spm"\n[runtime]\ntarget = "cortex-m4f"\n'
        '[coupling]\nmode = "off"\n[budget]\nflash_bytes = 24000\n'
    )
    found = spring("emit", "--scene", tmp_path / "scene.toml", "--out", folder, "--json",
                   "--recording", recorded, "--fit")  # fmt: skip
    assert found.returncode == 0, found.stderr
    result = json.loads(found.stdout)
    assert result["flash_bytes"] <= 24000
    checked = spring("validate", folder, "--recording", recorded, "--json")
    told = next(line for line in found.stderr.splitlines() if line.startswith("fitted: "))
    measured = json.loads(checked.stdout)
    assert float(told.split("RMSE ")[1].split()[0]) == pytest.approx(measured["rmse_n"], rel=1e-3)
    assert measured["mismatches"] == 0
    assert json.loads((folder / "manifest.json").read_text())["provenance"]["left_out"]


def assert_same(batch: Batch, force_n: np.ndarray, notes: np.ndarray) -> None:
    bits = f"u{force_n.dtype.itemsize}"
    assert np.sum(batch.force_n.view(bits) != force_n.view(bits)) == 0
    assert np.sum(batch.notes != notes) == 0


@pytest.mark.few(0, 8)
@pytest.mark.parametrize(("variant", "shape"), CASES)
def test_same_bits_on_every_board(tmp_path: Path, variant: str, shape: str) -> None:
    need(*BOARDS)
    model = model_file(tmp_path, model_of(variant))
    emit(target_scene("cortex-m4f", **SHAPES[shape]), model, tmp_path / "c", accept_unsafe=True)
    position = long_motion().astype(np.float32)
    velocity = differentiate(position, 1e-3)
    force_n, notes = Replay(SceneLibrary(tmp_path / "c")).run(position, velocity)
    assert np.ptp(force_n) > 1.0
    assert np.bitwise_or.reduce(notes) & 4, "the fallback outside was not visited"
    for board in BOARDS.values():
        batch = run_batch(
            tmp_path / "c", read_emission(tmp_path / "c").plan, board, steps(position, velocity)
        )
        assert len(batch.force_n) == TICKS
        assert_same(batch, force_n, notes)


@pytest.mark.parametrize("number", ["float32", "float64"])
@pytest.mark.parametrize("board", list(BOARDS))
def test_idle_reset_and_doubles_are_the_same_too(tmp_path: Path, board: str, number: str) -> None:
    need(board)
    chosen = target_scene(BOARDS[board].target, number=number, mode="tool", prefix="eco")
    emit(chosen, model_file(tmp_path, fitted("rf-fd")), tmp_path / "c", accept_unsafe=True)
    real = np.float32 if number == "float32" else np.float64
    position = long_motion()[:1500].astype(real)
    rows = steps(position, differentiate(position, 1e-3))
    rows["dt_s"], call = 1e-3, rows["call"]
    call[400:450] = CALL_IDLE  # longer than the watchdog waits
    call[600] = CALL_RESET
    if (board, number) != ("netduinoplus2", "float64"):  # its counter holds one tick of those
        call[700:705] = CALL_IDLE
    batch = run_batch(tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS[board], rows)
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
