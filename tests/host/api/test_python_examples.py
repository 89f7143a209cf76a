"""The code of README.md and docs/how-to/python.md, run as it stands there."""

import re

import numpy as np
import pytest
from support.paths import ROOT


def example(file: str) -> str:
    """Its blocks of Python, in the order of the page."""
    found = re.findall(r"^```python\n(.*?)^```", (ROOT / file).read_text(), re.M | re.S)
    assert found, file
    return "\n".join(found)


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.slow
def test_six_lines_of_the_readme():
    code = example("README.md")
    assert len([line for line in code.splitlines() if line.strip()]) <= 6
    names: dict = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["force_n"].shape == names["training"][0].position_m.shape
    assert np.max(np.abs(names["force_n"] - names["training"][0].force_n)) < 0.2


def test_from_a_recording_to_a_felt_session(capsys):
    names: dict = {}
    exec(compile(example("docs/how-to/python.md"), "docs/how-to/python.md", "exec"), names)
    assert "mN" in capsys.readouterr().out
    assert names["session"].error is None
    assert names["session"].result()["ticks"] == len(names["felt"][0].force_n)
    assert names["felt"][0].force_n.max() > 0.5
