"""Commands that take recordings: behind their arguments or by --recording, to one effect."""

import json
from pathlib import Path

import pytest
from support.in_process import spring
from support.small import training


def test_validate_takes_recordings_by_place_and_by_name(job: Path) -> None:
    one, two = (job / "rec" / f"{item.name}.h5" for item in training()[:2])
    found = []
    for given in ((one, two), ("--recording", one, "--recording", two), (one, "--recording", two)):
        done = spring("validate", job / "c", *given, "--json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads(done.stdout))
    assert found[0]["rmse_n"] == found[1]["rmse_n"] == found[2]["rmse_n"]
    assert found[0]["samples"] == sum(len(item.force_n) for item in training()[:2])


@pytest.mark.parametrize("words", [("validate", "c"), ("bench",)])
def test_none_is_a_line_and_status_2(words: tuple[str, ...], job: Path) -> None:
    done = spring(*words)
    assert done.returncode == 2
    assert "Missing recordings" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("given", [("none.h5",), ("--recording", "none.h5")])
def test_bench_takes_them_too(given: tuple[str, ...], tmp_path: Path) -> None:
    done = spring("bench", *given, "--out", tmp_path / "b")
    assert done.returncode == 3
    assert "none.h5: no such file" in done.stderr
