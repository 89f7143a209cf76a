"""What a sweep keeps: resumed after a kill, nothing repeated, nothing of other code; no orphans."""

import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from unittest import mock

import psutil
import pytest
from support.bench_folder import CANDIDATES, asked, bench_folder, command, small, write_training
from support.in_process import spring
from support.paths import ROOT

from springpot.host.evidence.benchmark import run as bench_run
from springpot.host.evidence.benchmark.isolated import missing_for
from springpot.host.evidence.benchmark.run import run_bench
from springpot.host.evidence.benchmark.store import code_hash, read_result


def test_without_an_emulator_the_count_is_null_says_why_and_is_made_later(tmp_path: Path) -> None:
    folder = tmp_path / "bench"
    shutil.copytree(bench_folder(), folder)
    shutil.rmtree(folder / "instructions")
    with (
        small(),
        mock.patch("springpot.host.evidence.benchmark.isolated.missing", lambda _: "no emulator"),
    ):
        result = run_bench(asked(), folder, "without")
    assert (result["computed"], result["computed_isolated"]) == (0, 0)
    chosen = [item for item in result["points"] if item["bounded"] is not None]
    assert chosen
    for item in chosen:
        assert item["instructions"] is None
        assert item["instructions_why"] == "no emulator"
    with small():
        again = run_bench(asked(), folder, "with")
    assert again["computed_isolated"] == (0 if missing_for("cortex-m4f") else len(chosen))
    assert again["points"] == read_result(bench_folder())["points"]


def test_other_code_measures_again(tmp_path: Path) -> None:
    for floor in ("runtime_c", "codegen", "trainer", "host"):
        shutil.copytree(ROOT / floor, tmp_path / floor)
    before = code_hash()
    assert code_hash.__wrapped__(tmp_path) == before
    for name in ("runtime_c/src/sp_guard.h", "runtime_c/flags.mk", "codegen/plan/plan.py",
                 "trainer/models/rf_fd.py", "host/wings/evidence/benchmark/measure.py",
                 "host/native/replay.py", "host/stability/check.py",
                 "host/wings/boards/emulator.py", "host/simulation/hand_loop.py"):  # fmt: skip
        file = tmp_path / name
        text = file.read_text()
        file.write_text(text + "\n")
        assert code_hash.__wrapped__(tmp_path) != before, name
        file.write_text(text)
    for name in ("benchmark/report.py", "benchmark/run.py", "commands/bench.py"):
        page = tmp_path / "host" / "wings" / "evidence" / name
        page.write_text(page.read_text() + "\n")  # measures nothing
    assert code_hash.__wrapped__(tmp_path) == before


def test_points_of_other_code_are_not_taken_over(tmp_path: Path) -> None:
    one = CANDIDATES[4:5]
    folder = tmp_path / "bench"
    shutil.copytree(bench_folder(), folder)  # by this code, before there is another
    with (
        small(lambda *_: list(one)),
        mock.patch.object(bench_run, "code_hash", lambda: "another"),
    ):
        result = run_bench(asked(), folder, "springpot bench")
    assert result["computed"] == 1
    assert result["computed_isolated"] >= 1
    old = {item["key"] for item in read_result(bench_folder())["points"]}
    assert {item["key"] for item in result["points"]}.isdisjoint(old)


@pytest.mark.slow
def test_a_killed_sweep_resumes_without_repeating(tmp_path: Path) -> None:
    recordings = write_training(tmp_path / "training")
    out = tmp_path / "bench"
    arguments = ["bench", "--recording", str(recordings), "--model", "hammerstein", "--json",
                 "--out", str(out)]  # fmt: skip
    first = subprocess.Popen(
        command(*arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    while first.poll() is None and len(list(out.glob("points/*.json"))) < 2:
        time.sleep(0.02)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    known = {file: file.stat().st_mtime_ns for file in out.glob("points/*.json")}
    assert 2 <= len(known) < 7, "the kill came too late"
    (out / "points" / "half.json.part").write_text("{")  # what a kill leaves behind
    result = spring(*arguments)
    assert result.returncode == 0, result.stderr
    metadata = json.loads(result.stdout)
    assert metadata["computed"] == len(metadata["points"]) - len(known) == 7 - len(known)
    assert {file: file.stat().st_mtime_ns for file in known} == known


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGKILL,
        pytest.param(signal.SIGTERM, marks=pytest.mark.slow),
        pytest.param(signal.SIGINT, marks=pytest.mark.slow),
    ],
)
def test_nothing_outlives_a_sweep_that_was_killed(tmp_path: Path, number: int) -> None:
    recordings = write_training(tmp_path / "training")
    out = tmp_path / "bench"
    sweep = subprocess.Popen(
        command("bench", "--recording", str(recordings), "--model", "rf-fd", "--out", str(out)),
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    while sweep.poll() is None and not list(out.glob("points/*.json")):
        time.sleep(0.02)
    assert sweep.poll() is None, "the sweep ended by itself"
    workers = psutil.Process(sweep.pid).children(recursive=True)
    assert len(workers) >= min(2, os.cpu_count() or 1)
    sweep.send_signal(number)
    assert sweep.wait(30) != 0
    gone, left = psutil.wait_procs(workers, timeout=30)
    assert all(worker.status() == psutil.STATUS_ZOMBIE for worker in left), gone
