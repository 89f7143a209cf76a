"""Mislabelled files: each is refused, warned of by its cause, or makes next to no difference."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.files.mistakes import mistaken
from support.files.recording_files import pressed_object
from support.in_process import spring
from support.paths import ROOT

from springpot.trainer.recordings.recording_file import read_recordings

TABLE = tomllib.loads((ROOT / "tests/data/mistakes.toml").read_text("utf-8"))
MISTAKES: dict[str, dict[str, Any]] = TABLE["factors"] | TABLE["faults"]
LIMIT = 0.1  # of the peak force


def cases() -> Iterator[tuple[str, str]]:
    for part in TABLE["cases"]:
        for mistake in part["mistakes"]:
            for name in part["objects"]:
                yield mistake, name


CASES = list(cases())


def error(folder: Path, facts: dict[str, Any]) -> float:
    """Error of the recorded force along the recorded motion, rms over the peak of either."""
    (recording,) = read_recordings([folder])
    true_n = pressed_object(facts).force(recording.position_m, recording.dt_s)
    peak_n = max(float(np.abs(recording.force_n).max()), float(true_n.max()))
    return float(np.sqrt(np.mean((recording.force_n - true_n) ** 2))) / peak_n


@pytest.mark.few(59)
@pytest.mark.parametrize(("mistake", "name"), CASES, ids=lambda part: part)
def test_mistake(mistake: str, name: str, tmp_path: Path) -> None:
    facts, stated = TABLE["objects"][name], MISTAKES[mistake]
    file = tmp_path / "press.csv"
    file.write_text(mistaken(facts, mistake, stated))
    found = spring("import", file, "--out", tmp_path / "out")
    # What was understood of the header, and the names of folders, name no cause.
    said = (found.stdout + found.stderr).replace(str(tmp_path), "").splitlines()
    lines = [line for line in said if "numbers from row" not in line]
    named = any(word in line for word in stated["names"] for line in lines)
    wrong = found.returncode == 0 and not named and error(tmp_path / "out", facts) > LIMIT
    assert found.returncode in (0, 3)
    assert wrong == (f"{mistake}, {name}" in TABLE["silent"]), found.stdout + found.stderr
