"""The benchmark: points, front and picks; resumed after a kill; emission from its choice."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.bench_folder import CANDIDATES, bench_folder, write_training
from support.in_process import spring
from support.small import training

from springpot.codegen.errors import BudgetError, DataError, UsageError
from springpot.codegen.model.model_file import model_hash, read_model
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.units import instruction_bound
from springpot.host.evidence.benchmark.choice import choose_within
from springpot.host.evidence.benchmark.isolated import missing_for
from springpot.host.evidence.benchmark.measure import bench_scene
from springpot.host.evidence.benchmark.picks import (
    PlatformBudget,
    budgets,
    misfit,
    pick,
    why,
)
from springpot.host.evidence.benchmark.point import Point
from springpot.host.evidence.benchmark.store import Store, read_result
from springpot.host.evidence.splits import (
    blocks,
    cross_validated_rmse_n,
    holdout,
    recording_splits,
)
from springpot.host.evidence.sweep import default_sweep
from springpot.host.native.toolchain import missing_tools
from springpot.trainer.kinds import fit_kind, fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.training_set import training_set

KEYS = {"model", "options", "rmse_n", "rmse_percent_of_peak", "tick_ns_hot", "tick_ns_p999",
        "instructions", "flash_bytes", "ram_bytes", "fit_s", "active_cells", "bounded",
        "pareto"}  # fmt: skip
UNMEASURED = bool(missing_tools("cortex-m4f"))  # the sizes of the small benchmark


def test_the_default_sweep_is_wide_enough() -> None:
    sweep = default_sweep(1e-3, FitOptions())
    assert len({candidate.kind for candidate in sweep}) == 5
    assert len({json.dumps(candidate.as_dict()) for candidate in sweep}) == len(sweep) == 54
    assert {c.options.engine for c in sweep} >= {None, "fir-fast", "recursive"}
    assert {c.number for c in sweep} == {"float32", "float64"}
    plain = {c.kind for c in sweep if not c.named_options()}
    assert plain >= {"rf-fd", "rbf-fd", "rbf-pv"}  # the paper's


def test_keys_and_what_is_null() -> None:
    result = read_result(bench_folder())
    assert {"points", "machine", "compiler", "flags"} <= set(result)
    assert len(result["points"]) == len(CANDIDATES) - 1
    picked = {found["point"] for found in result["picks"].values()}
    assert list(result["picks"]) == ["pc-1khz", "pc-4khz", "cortex-m4f"]
    for point in result["points"]:
        assert set(point) >= KEYS
        chosen = point["pareto"] or point["key"] in picked
        assert (point["tick_ns_p999"] is not None) == chosen
        assert (point["bounded"] is not None) == chosen
        counts = chosen and not missing_for("cortex-m4f")
        assert (point["instructions"] is not None) == counts
        assert 0.0 < point["rmse_n"] < 5.0
        assert point["cv_rmse_n"] > 0.0
        assert Store(bench_folder()).model_file(point["key"]).exists()
    (refused,) = result["refused"]
    assert "--window-s" in refused["error"]
    for key, matrix in result["closed_loop"].items():
        assert len(matrix) == 66, key


def test_instructions_are_those_of_the_emulated_tick() -> None:
    if why := missing_for("cortex-m4f"):
        pytest.skip(why)
    for item in read_result(bench_folder())["points"]:
        if item["instructions"] is None or item["number"] == "float64":
            continue  # no bound is known of doubles in software
        model = read_model(Store(bench_folder()).model_file(item["key"]))
        plan = make_plan(model, bench_scene(item["number"], "cortex-m4f"), accept_unsafe=True)
        bound = instruction_bound(plan)
        assert bound.tick / 2.2 < item["instructions"] <= bound.tick


def test_fits_that_share_are_the_fits_by_themselves() -> None:
    data = training_set(training(), FitOptions().smooth_s)
    for kind in ("hammerstein", "rbf-fd", "rbf-fd", "rf-fd"):
        for options in (FitOptions(trees=5), FitOptions(trees=5, n_centers=20, poles=3)):
            shared = fit_kind(kind, "x", data, options)
            by_itself = fit_model(kind, "x", training(), options)
            assert model_hash(shared.model) == model_hash(by_itself.model)
            assert shared.fit_s > 0.0


def point(key: str, error: float, tick: float, flash: int | None, **others: Any) -> Point:
    metadata: dict[str, Any] = {"key": key, "cv_rmse_n": error, "tick_ns_hot": tick}
    metadata |= {"flash_bytes": flash, "ram_bytes": 100, "active_cells": 0, "any_rate": True}
    return Point.from_dict(metadata | {"number": "float32"} | others)


def test_a_pick_fits_is_passive_and_bounded() -> None:
    budget = PlatformBudget("board", "board", flash_bytes=5000)
    points = [
        point("large", 1.0, 50.0, 9000),
        point("active", 1.1, 50.0, 500, active_cells=2),
        point("wild", 1.2, 50.0, 500),
        point("slow", 1.300, 90.0, 500),
        point("good", 1.301, 50.0, 500),
        point("noise", 1.302, 49.0, 500),
        point("plain", 1.4, 10.0, 500),
    ]

    def bounded(candidate: Point) -> Point:
        return replace(candidate, bounded=candidate.key != "wild")

    found = pick(points, budget, 1000.0, bounded)
    assert found.key == "good"
    only_unbounded = pick(points[:3], budget, 1000.0, bounded)
    assert only_unbounded.key == "wild"  # and it says so

    def counted(candidate: Point) -> Point:
        instructions = 9000 if candidate.key in {"wild", "slow"} else 700
        return replace(bounded(candidate), instructions=instructions)

    tight = PlatformBudget("board", "board", flash_bytes=5000, instructions=8000)
    found = pick(points, tight, 1000.0, counted)
    assert found.key == "good"
    assert pick([points[2]], tight, 1000.0, counted) is None
    told = why(only_unbounded, points, budget, 1000.0)
    assert "simulation only" in told
    assert pick(points[:2], budget, 1000.0, bounded) is None


def test_what_does_not_fit_and_why() -> None:
    pc, fast, board = budgets("cortex-m4f")
    assert (pc.tick_us, fast.tick_us) == (100.0, 25.0)
    assert misfit(point("x", 1.0, 99e3, 1), pc, 1000.0) is None
    assert "us a tick" in str(misfit(point("x", 1.0, 99e3, 1, tick_ns_p99=101e3), pc, 1000.0))
    windowed = point("x", 1.0, 50.0, 1, any_rate=False)
    assert "hold at 1000 Hz only" in str(misfit(windowed, fast, 1000.0))
    assert misfit(windowed, fast, 4000.0) is None
    assert "of flash" in str(misfit(point("x", 1.0, 1.0, 300_000), board, 1000.0))
    assert misfit(point("x", 1.0, 1.0, None), board, 1e3) is None
    doubles = point("x", 1.0, 1.0, 1, number="float64")
    assert "in software" in str(misfit(doubles, board, 1000.0))
    assert misfit(doubles, pc, 1000.0) is None
    counted = point("x", 1.0, 1.0, 1, instructions=9000)
    assert "instructions" in str(misfit(counted, board, 1000.0))


def test_held_out_errors_are_of_recordings_never_seen() -> None:
    options = FitOptions()
    folds = recording_splits(training(), options.smooth_s, options.seed)
    for fold in folds:
        seen = {item.name for item in fold.data.recordings}
        assert seen.isdisjoint(item.name for item in fold.held)
    assert sum(len(fold.held) for fold in folds) == len(training())
    forest = cross_validated_rmse_n("rf-fd", folds, FitOptions(trees=20))
    assert 0.001 < cross_validated_rmse_n("hammerstein", folds, options) < forest
    assert len(blocks(training()[:1])) == 3
    kept, aside = holdout(training(), 0)
    assert len(aside) == 2
    strongest = max(training(), key=lambda item: float(item.force_n.max()))
    assert strongest in kept
    begin, end = holdout(training()[:1], 0)
    assert len(begin[0].force_n) + len(end[0].force_n) == len(training()[0].force_n)


def test_emission_of_a_pick_is_the_points_model(tmp_path: Path) -> None:
    result = read_result(bench_folder())
    picked = result["picks"]["cortex-m4f"]["point"]
    chosen = next(item for item in result["points"] if item["key"] == picked)
    done = spring("emit", "--pick", "cortex-m4f", "--bench", str(bench_folder()), "--out",
                  str(tmp_path / "c"), "--json")  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert model_hash(read_model(tmp_path / "c/from/model.spm")) == chosen["hash"]
    scene = json.loads((tmp_path / "c/from/scene.json").read_text())
    assert scene["runtime"]["target"] == "cortex-m4f"
    assert scene["budget"]["flash_bytes"] == 256 * 1024
    fast = spring("emit", "--pick", "pc-4khz", "--bench", str(bench_folder()), "--out",
                  str(tmp_path / "d"))  # fmt: skip
    assert fast.returncode == 0, fast.stderr
    assert "recordings' 1000 Hz" in fast.stderr


def test_emission_within_a_budget() -> None:
    best, _ = choose_within(bench_folder(), PlatformBudget("mine", "mine", tick_us=100.0))
    stable = [item for item in read_result(bench_folder())["points"] if item["bounded"]]
    assert best.cv_rmse_n <= 1.005 * min(item["cv_rmse_n"] for item in stable)
    told = "flash could not be measured" if UNMEASURED else "the smallest, above 100 bytes of flash"
    with pytest.raises(BudgetError, match=told):
        choose_within(bench_folder(), PlatformBudget("mine", "mine", flash_bytes=100))


def test_wrong_use_is_one_line(tmp_path: Path) -> None:
    folder = str(bench_folder())
    for arguments, status, told in (
        (["emit", "--out", "x"], 2, "--pick NAME"),
        (["emit", "--pick", "moon", "--bench", folder, "--out", "x"], 2, "it has pc-1khz"),
        (["emit", "--pick", "pc-1khz", "--flash", "9", "--bench", folder, "--out", "x"], 2, "one"),
        (["emit", "--pick", "pc-1khz", "--bench", str(tmp_path), "--out", "x"], 3, "no benchmark"),
        (
            ["emit", "--flash", "10", "--bench", folder, "--out", "x"],
            4,
            "apt-get install gcc-arm-none-eabi" if UNMEASURED else "raise the budget",
        ),
    ):
        done = spring(*arguments)
        assert done.returncode == status, done.stderr
        assert told in done.stderr
        assert len(done.stderr.strip().splitlines()) == 1
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(UsageError, match="no earlier benchmark"):
        Store(tmp_path).prepare()
    with pytest.raises(DataError, match="no benchmark"):
        read_result(tmp_path)


@pytest.mark.parametrize(
    "address", [pytest.param("tcp://127.0.0.1:9", marks=pytest.mark.slow), "nonsense://x"]
)
def test_no_scheduler_is_told(tmp_path: Path, address: str) -> None:
    recordings = write_training(tmp_path / "training")
    done = spring("bench", "--recording", str(recordings), "--model", "springpot", "--out",
                  str(tmp_path / "bench"), "--dask", address)  # fmt: skip
    assert done.returncode == 2
    assert "no scheduler answers" in done.stderr.splitlines()[-1]
