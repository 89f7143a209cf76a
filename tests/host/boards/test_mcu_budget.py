"""Before flashing: the bound holds, and what does not fit is refused, or fitted."""

import dataclasses
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.c.mcu import long_motion, need, target_scene
from support.in_process import spring
from support.small import damage, flow, model_file, press, recording, training

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Memory
from springpot.codegen.model.regressors import Linear
from springpot.codegen.notes import HELD, RESYNC
from springpot.codegen.plan import instruction_bound
from springpot.codegen.scene import Guard, Scene
from springpot.host.emission.boards import BOARDS, run_batch, steps
from springpot.host.emission.emission import emit
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import write_recording

pytestmark = [pytest.mark.board, pytest.mark.slow]

BOUND_ON = ("mps2-an386", "mps2-an500", "virt")
FOREST = {"trees": 5, "leaf": 20}
VARIANTS = {
    "rf-fd": ("rf-fd", FOREST),
    "rf-fd deep": ("rf-fd", {"trees": 8, "leaf": 1}),
    "rf-fd rounded": ("rf-fd", {"trees": 20, "leaf": 5, "round_features": True}),
    "rf-fd fast": ("rf-fd", {**FOREST, "engine": "fir-fast", "round_features": True}),
    "rf-fd few orders": ("rf-fd", {**FOREST, "engine": "fir-fast", "orders": (0.1, 0.2)}),
    "rf-fd long": ("rf-fd", {**FOREST, "window_s": 2.0}),
    "rbf-fd": ("rbf-fd", {}),
    "rbf-fd fast": ("rbf-fd", {"engine": "fir-fast"}),
    "rbf-pv": ("rbf-pv", {}),
    "rbf-pv averaged": ("rbf-pv", {"velocity_weight": 0.7}),
    "rf-fd past positions": ("rf-fd", {**FOREST, "past_positions": True}),
    "hammerstein": ("hammerstein", {}),
    "springpot": ("springpot", {}),
}
# What no fit of these recordings chooses.
OF_DEPTH = {
    "rates by depth": {"n_by_depth": 4, "rate_ratio": 16.0},
    "flow": {"flow": flow(4.0), "recovers": True},
    "damage": {"n_by_depth": 8, "rate_ratio": 1 / 16, "damage": damage(np.ones(9))},
}
MEMORY = {"conditioned": Memory(np.full(8, -0.01), *np.zeros((2, 0))), "starts_conditioned": True}
OF_DEPTH["conditioned"] = OF_DEPTH["rates by depth"] | MEMORY
SHAPES = {
    "off": {},
    "tool": {"mode": "tool", "smoothing_s": 1e-3},
    "proxy": {"mode": "proxy"},
}

# A coupling costs the same with every model.
CASES = [
    *((variant, "off") for variant in (*VARIANTS, *OF_DEPTH, "linear")),
    *((variant, shape) for variant in ("rf-fd fast", "hammerstein") for shape in ("tool", "proxy")),
]


@cache
def fitted(variant: str) -> Model:
    if variant in OF_DEPTH:
        return passive_of(branches=8, stops=2, **OF_DEPTH[variant])
    if variant == "linear":
        return dataclasses.replace(fitted("rf-fd"), regressor=Linear(0.5, np.linspace(-1, 2, 10)))
    kind, options = VARIANTS[variant]
    return fit_model(kind, "x", training(), FitOptions(seed=1, **options)).model


def passive_of(branches: int, stops: int, **of_depth: Any) -> Model:
    """A passive model of so many branches and stops."""
    rng = np.random.default_rng(1)
    whole = fitted("hammerstein")
    passive = dataclasses.replace(
        whole.hammerstein,
        elastic_n=rng.random(9),
        tau_s=np.geomspace(2e-3, 5.0, branches),
        branch_n=rng.random((branches, 9)),
        radius_m=np.array([0.02, 0.2, 0.5])[:stops] * whole.hammerstein.span_m,
        stop_n=rng.random((stops, 9)),
        **{"conditioned": None, **of_depth},
    )
    return dataclasses.replace(whole, hammerstein=passive)


def scene_of(target: str, shape: str) -> Scene:
    chosen = target_scene(target, **SHAPES[shape])
    return dataclasses.replace(chosen, guard=Guard(outside="zero")) if shape == "proxy" else chosen


def restarting() -> np.ndarray:
    """From above the surface to many depths: a forest's way is longer at some than at others."""
    away = np.full(7, -0.03)
    return np.concatenate([[*away, *np.full(7, at)] for at in np.linspace(2e-4, 0.02, 30)])


def after_silence(notes: np.ndarray) -> np.ndarray:
    """Ticks, (n,), that make up for some without a sample."""
    held = (notes & HELD) != 0
    return ((notes & RESYNC) == 0) & ~held & np.concatenate([[False], held[:-1]])


@pytest.mark.parametrize(("variant", "shape"), CASES)
def test_the_bound_is_above_what_is_counted(tmp_path: Path, variant: str, shape: str) -> None:
    """All boards run one emission: their C is the same but for the hash in it."""
    need(*BOUND_ON)
    model = fitted(variant)
    file = model_file(tmp_path, model)
    emission = emit(scene_of("cortex-m4f", shape), file, tmp_path / "c", accept_unsafe=True)
    told = dataclasses.asdict(instruction_bound(emission.plan))
    assert emission.manifest["instructions"] == told
    position = np.concatenate([long_motion()[1500:7500], restarting()]).astype(np.float32)
    calls = steps(position, backward_velocity(position, 1e-3))
    for board in BOUND_ON:
        batch = run_batch(tmp_path / "c", BOARDS[board], calls)
        bound = instruction_bound(make_plan(model, scene_of(BOARDS[board].target, shape), True))
        restarts = (batch.notes & RESYNC) != 0
        late = after_silence(batch.notes)
        assert restarts.sum() > 60 and late.any()
        most, max_restarting, max_late = (
            int(batch.instructions[rows].max()) for rows in (~restarts & ~late, restarts, late)
        )
        assert most <= bound.tick <= 1.25 * most, board
        assert max_late <= bound.after_silence
        above = 1.35 if variant == "conditioned" else 1.25  # a compiler fills its state only once
        assert max_restarting <= bound.restart <= above * max_restarting, board


@pytest.mark.parametrize(("variant", "number"), [("rf-fd", "float32"), ("rbf-pv", "float64")])
def test_the_boards_have_one_c(variant: str, number: str) -> None:
    def parts(target: str) -> dict[str, str]:
        plan = make_plan(fitted(variant), target_scene(target, number=number, mode="proxy"), True)
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
    calls = steps(position, backward_velocity(position, 1e-3))
    batch = run_batch(tmp_path / "c", BOARDS["mps2-an386"], calls)
    restarts = (batch.notes & RESYNC) != 0
    most = int(batch.instructions[~restarts & ~after_silence(batch.notes)].max())
    assert most <= min(emission.manifest["instructions"]["tick"], 640)
    assert emission.footprint.flash_bytes <= 4400


def test_fit_makes_it_fit(tmp_path: Path) -> None:
    need("mps2-an386")
    model_file(tmp_path, fitted("rf-fd deep"))
    recorded, folder = tmp_path / "val.h5", tmp_path / "c"
    write_recording(recorded, recording("val", press(1.5, 0.011, cycles=3)))
    (tmp_path / "scene.toml").write_text(
        'schema = 1\nname = "big"\nmodel = "model.spm"\n[runtime]\ntarget = "cortex-m4f"\n'
        '[coupling]\nmode = "off"\n[budget]\nflash_bytes = 24000\ntick_instructions = 6000\n'
    )
    found = spring("emit", "--scene", tmp_path / "scene.toml", "--out", folder, "--json",
                   "--recording", recorded, "--fit")  # fmt: skip
    assert found.returncode == 0, found.stderr
    result = json.loads(found.stdout)
    assert result["flash_bytes"] <= 24000
    assert result["instructions"]["tick"] <= 6100
    checked = spring("validate", folder, "--recording", recorded, "--json")
    told = next(line for line in found.stderr.splitlines() if line.startswith("fitted: "))
    measured = json.loads(checked.stdout)
    assert float(told.split("RMSE ")[1].split()[0]) == pytest.approx(measured["rmse_n"], rel=1e-3)
    assert measured["mismatches"] == 0
    assert json.loads((folder / "manifest.json").read_text())["provenance"]["left_out"]
