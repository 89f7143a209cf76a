"""The benchmark: rows, the front, what is remembered, model files, the page, a Dask cluster."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from sklearn.linear_model import Ridge
from support.in_process import spring
from support.small import press, recording, small_model, training, written_model

from springpot import write_model
from springpot.codegen.errors import UsageError
from springpot.host.bench import bench as bench_module, front
from springpot.host.bench.bench import Bench, holdout, run_bench
from springpot.host.bench.front import pareto_front
from springpot.host.bench.measure import Candidate, default_sweep
from springpot.host.emission.boards import BOARDS, missing
from springpot.host.ensemble import ensemble_data, from_ensemble
from springpot.host.files import write_recordings
from springpot.host.native.toolchain import missing_tools
from springpot.trainer.models.fit import FitOptions

PLAIN = FitOptions()
SMALL = [
    Candidate("rf-fd", FitOptions(trees=5, leaf=20, engine="fir-fast", round_features=True)),
    Candidate("rbf-pv", PLAIN),
    Candidate("hammerstein", FitOptions(poles=4)),
    Candidate("rbf-fd", FitOptions(window_s=1e-3)),  # refused: under ten samples
]
KEYS = {"model", "options", "rmse_n", "rmse_percent_of_peak", "tick_ns_hot", "tick_ns_p999",
        "instructions", "flash_bytes", "ram_bytes", "fit_s", "active_cells", "bounded",
        "pareto", "why"}  # fmt: skip


def asked(models: tuple[str, ...] = ()) -> Bench:
    validation = (
        recording("mixed", press(0.8) + 0.2 * press(0.8)[::-1]),
        recording("other", press(2.0, 0.009)),
    )
    return Bench(training(), validation, "cortex-m4f", models=models)


def run(folder: Path, candidates: list[Candidate], models: tuple[str, ...] = ()) -> dict[str, Any]:
    with (
        mock.patch.object(bench_module, "default_sweep", lambda *_: candidates),
        mock.patch.object(front, "PACED_S", 0.2),
    ):
        return run_bench(asked(models), folder, "springpot bench --recording small")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("bench")
    run(found, SMALL)
    return found


def test_the_default_sweep_is_wide_enough() -> None:
    sweep = default_sweep(1e-3, PLAIN)
    assert len({candidate.kind for candidate in sweep}) == 5 and len(set(sweep)) == len(sweep) == 54
    assert {c.options.engine for c in sweep} >= {None, "fir-fast", "recursive"}
    plain = {c.kind for c in sweep if not c.named_options()}
    assert plain >= {"rf-fd", "rbf-fd", "rbf-pv"}  # the paper's


def test_rows_and_what_is_null(folder: Path) -> None:
    result = json.loads((folder / "bench.json").read_text())
    assert {"points", "machine", "compiler", "flags"} <= set(result)
    assert len(result["points"]) == len(SMALL) - 1
    board = next(board for board in BOARDS.values() if board.target == "cortex-m4f")
    for point in result["points"]:
        assert set(point) >= KEYS and (point["tick_ns_p999"] is not None) == point["pareto"]
        assert (point["bounded"] is not None) == point["pareto"]
        counts = point["pareto"] and not missing(board)
        assert (point["instructions"] is not None) == counts
        assert (point["flash_bytes"] is None) == bool(missing_tools("cortex-m4f"))
        assert bool(point["why"]) == bool(missing_tools("cortex-m4f"))
        assert 0.0 < point["rmse_n"] < 5.0 and (folder / point["file"]).is_file()
    errors = [point["rmse_n"] for point in result["points"]]
    assert errors == sorted(errors)
    (refused,) = result["refused"]
    assert "--window-s" in refused["error"]


def test_what_is_measured_is_not_measured_again(folder: Path, tmp_path: Path) -> None:
    again = tmp_path / "bench"
    shutil.copytree(folder, again)
    before = json.loads((folder / "bench.json").read_text())
    with mock.patch.object(bench_module, "Parallel", None):  # no worker may start
        after = run(again, SMALL)
    assert after["points"] == before["points"]
    first, second = asked().validation
    fewer = replace(asked(), validation=(second,))
    stiffer = replace(asked(), validation=(replace(first, force_n=2.0 * first.force_n), second))
    for other in (
        mock.patch.object(bench_module, "code_hash", lambda: "other"),
        mock.patch(f"{__name__}.asked", lambda _: fewer),
        mock.patch(f"{__name__}.asked", lambda _: stiffer),
    ):
        with other, mock.patch.object(bench_module, "Parallel", None), pytest.raises(TypeError):
            run(again, SMALL)


@pytest.mark.slow
def test_a_model_file_stands_beside_the_kinds(tmp_path: Path) -> None:
    file = tmp_path / "mine.spm"
    write_model(file, from_ensemble(Ridge().fit(*ensemble_data(training())), training()))
    forest = small_model()  # with twice the force: it errs more, and takes longer
    wrong = replace(forest.regressor, value_n=2.0 * forest.regressor.value_n)
    write_model(tmp_path / "wrong.spm", replace(forest, regressor=wrong))
    result = run(tmp_path / "bench", [], (str(file), str(tmp_path / "wrong.spm")))
    point, worse = result["points"]
    assert point["model"] == str(file) and point["fit_s"] is None
    assert [one["pareto"] for one in (point, worse)] == [True, False]
    counts = not missing(next(one for one in BOARDS.values() if one.target == "cortex-m4f"))
    for one in (point, worse):
        assert one["tick_ns_p999"] > 0.0 and (one["instructions"] is not None) == counts
    write_model(file, written_model())  # of which no board can be
    (point,) = run(tmp_path / "pc", [], (str(file),))["points"]
    assert point["ram_bytes"] is point["flash_bytes"] is None and "libm" in point["why"]
    with pytest.raises(UsageError, match="neither a file nor one of rf-fd"):
        run(tmp_path / "bench", [], ("no-such",))


def test_the_front() -> None:
    def point(rmse_n: float, tick_ns_hot: float, flash_bytes: int | None) -> dict[str, object]:
        return {"rmse_n": rmse_n, "tick_ns_hot": tick_ns_hot, "flash_bytes": flash_bytes}

    points = [point(1.0, 10.0, 100), point(1.1, 10.0, 100), point(2.0, 5.0, 100),
              point(2.1, 6.0, 90), point(2.1, 6.0, None), point(1.0, 10.0, 100)]  # fmt: skip
    assert pareto_front(points) == [True, False, True, True, False, True]


def test_holdout_keeps_the_strongest_for_training() -> None:
    recordings = training()
    strongest = max(recordings, key=lambda item: float(item.force_n.max()))
    for seed in range(20):
        kept, held = holdout(recordings, seed)
        assert {item.name for item in (*kept, *held)} == {item.name for item in recordings}
        assert strongest.name in {item.name for item in kept}
    (begin,), (end,) = holdout(recordings[:1], 0)
    assert len(begin.force_n) + len(end.force_n) == len(recordings[0].force_n)


@pytest.mark.slow
@mock.patch.object(front, "PACED_S", 0.2)
@mock.patch.object(bench_module, "default_sweep", lambda *_: SMALL[1:3])
def test_two_workers_give_the_points_of_one_machine(tmp_path: Path) -> None:
    from distributed import LocalCluster  # slow to load, and this test alone needs it

    recordings = str(tmp_path / "training")
    write_recordings(recordings, training()[::2])

    def points(name: str, *options: str) -> list[dict[str, Any]]:
        done = spring("bench", "--recording", recordings, "--json", "--out", str(tmp_path / name),
                      *options)  # fmt: skip
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)["points"]

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        found = points("cluster", "--dask", cluster.scheduler_address)
    alike = {(point["hash"], point["number"]): point for point in points("here")}
    assert len(found) == 2
    for one in found:
        for name in ("options", "rmse_n", "flash_bytes", "ram_bytes"):
            assert one[name] == alike[one["hash"], one["number"]][name]
