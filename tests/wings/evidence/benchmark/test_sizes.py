"""Sizes on the target: without its compiler they are null and say why; they are added later."""

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from support.bench_folder import CANDIDATES, asked, small
from support.c.cross_tools import path_with, path_without
from wings.evidence.benchmark.test_bench import point as made

from springpot.codegen.errors import BudgetError
from springpot.host.cli import springpot
from springpot.host.wings.evidence import parallel
from springpot.host.wings.evidence.benchmark.choice import choose_within
from springpot.host.wings.evidence.benchmark.picks import (
    PlatformBudget,
    budgets,
    pareto,
    pick,
    why,
)
from springpot.host.wings.evidence.benchmark.report import bench_page
from springpot.host.wings.evidence.benchmark.run import run_bench
from springpot.host.wings.evidence.benchmark.store import read_result
from springpot.host.wings.evidence.sweep import Candidate
from springpot.trainer.models.fit import FitOptions

REMEDY = "no compiler for cortex-m4f: `apt-get install gcc-arm-none-eabi`"


def in_this_process(
    work: Callable[[Any], Any], items: list[Any], dask: str | None
) -> Iterator[Any]:
    """Workers keep the PATH that they were started with."""
    return map(work, items)


@pytest.fixture(scope="module")
def without(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A benchmark of two models on a machine without a compiler for its target."""
    folder = tmp_path_factory.mktemp("sizes")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", path_without(folder / "bin"))
        return measured(folder / "bench", patch)[0]


def measured(folder: Path, patch: pytest.MonkeyPatch) -> tuple[Path, dict[str, Any]]:
    patch.setattr(parallel, "in_parallel", in_this_process)
    two = [CANDIDATES[4], Candidate("hammerstein", FitOptions(poles=3))]
    with small(lambda *_: list(two)):
        return folder, run_bench(asked(), folder, "springpot bench")


def test_an_unmeasured_size_is_null_and_says_why(without: Path) -> None:
    result = read_result(without)
    assert len(result["points"]) == 2
    for point in result["points"]:
        assert point["flash_bytes"] is point["stack_bytes"] is point["sizes_compiler"] is None
        assert point["why"] == REMEDY
        assert point["ram_bytes"] > 0
    found = result["picks"]["cortex-m4f"]
    assert found["point"] == result["picks"]["pc-1khz"]["point"]
    assert f"flash could not be measured ({REMEDY})" in found["why"]
    assert "could not be measured" not in result["picks"]["pc-1khz"]["why"]


def test_a_pick_of_unknown_flash_is_emitted(
    without: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", path_without(tmp_path / "bin"))
    arguments = ["emit", "--pick", "cortex-m4f", "--bench", str(without), "--json", "--out"]
    done = CliRunner().invoke(springpot, [*arguments, str(tmp_path / "c")], catch_exceptions=False)
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["flash_bytes"] is None
    assert f"flash and stack could not be measured: {REMEDY}" in done.stderr
    assert "not checked against the budget: flash, at most 262144 bytes" in done.stderr
    scene = json.loads((tmp_path / "c/from/scene.json").read_text())
    assert scene["runtime"]["target"] == "cortex-m4f"
    assert scene["budget"]["flash_bytes"] == 256 * 1024


def test_a_stated_limit_is_checked_or_refused(without: Path) -> None:
    with pytest.raises(BudgetError, match=r"--flash 9000: flash could not be measured \(no comp"):
        choose_within(without, PlatformBudget("mine", "mine", flash_bytes=9000))
    found, _ = choose_within(without, PlatformBudget("mine", "mine", ram_bytes=65536))
    assert found.ram_bytes <= 65536


def test_a_compiler_that_comes_later_adds_only_sizes(
    without: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = read_result(without)
    monkeypatch.setenv("PATH", path_without(tmp_path / "plain"))  # no emulator either
    monkeypatch.setenv("PATH", path_with(tmp_path / "bin"))
    folder = shutil.copytree(without, tmp_path / "bench")
    _, result = measured(folder, monkeypatch)
    assert (result["computed"], result["computed_sizes"], result["computed_isolated"]) == (0, 2, 0)
    for point, old in zip(result["points"], before["points"], strict=True):
        assert point["flash_bytes"] > 1000
        assert point["why"] is None
        assert point["sizes_compiler"]
        for name in ("key", "hash", "rmse_n", "tick_ns_hot", "point_s", "worker", "ram_bytes"):
            assert point[name] == old[name]
    assert "could not be measured" not in result["picks"]["cortex-m4f"]["why"]
    assert "unknown" not in bench_page(result, "bench").split("<h2>The recordings")[0]
    monkeypatch.setenv("PATH", path_without(tmp_path / "none"))  # what was measured stays
    _, again = measured(folder, monkeypatch)
    assert (again["computed"], again["computed_sizes"]) == (0, 0)
    assert [p["flash_bytes"] for p in again["points"]] == [
        p["flash_bytes"] for p in result["points"]
    ]


def test_a_size_that_is_not_known_neither_wins_nor_loses() -> None:
    known = {"bounded": True, "model": "x"}
    slow = made("slow", 2.0, 900.0, None, why=REMEDY, **known)
    assert pareto([slow, made("fast", 1.0, 50.0, 9000, **known)]) == {"fast"}
    *_, board = budgets("cortex-m4f")
    large = made("large", 0.5, 50.0, 300_000, **known)
    points = [slow, large]
    assert pick(points, board, 1000.0, lambda found: found) is slow
    assert "1 above 262144 bytes of flash" in why(slow, points, board, 1000.0)
    assert why(slow, points, board, 1000.0).endswith(f"({REMEDY}), and did not decide")
