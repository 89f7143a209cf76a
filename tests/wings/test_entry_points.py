"""Another package's command, kind, device and file format are used by their names."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.paths import TESTS

CLI = [sys.executable, "-c", "from springpot.host.cli import main; main()"]
SCENE = 'schema = 1\nname = "rig"\nmodel = "rig.spm"\n[runtime]\nrate_hz = 1000.0\n'


def installed(folder: Path) -> Path:
    """The package of tests/support/stranger, as pip installs it."""
    source, target = folder / "source", folder / "installed"
    shutil.copytree(TESTS / "support" / "stranger", source)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
           "--disable-pip-version-check", "--target", str(target), str(source)]  # fmt: skip
    subprocess.run(pip, check=True, capture_output=True)
    return target


def said(target: Path, folder: Path, *words: str) -> str:
    """Standard output of a command of springpot beside that package."""
    environment = {**os.environ, "PYTHONPATH": str(target)}
    result = subprocess.run([*CLI, *words], cwd=folder, env=environment, capture_output=True,
                            text=True, check=False)  # fmt: skip
    assert result.returncode == 0, result.stderr
    return result.stdout


def write_rig_file(path: Path) -> None:
    """Two seconds of pressing a spring that stiffens, at 1 kHz."""
    t_s = np.arange(4000) / 1000
    position_mm = 2.5 * (1 - np.cos(2 * np.pi * t_s))
    force_n = 0.8 * position_mm + 0.05 * position_mm**2
    np.savetxt(path, np.column_stack([position_mm, force_n]), header="soft-rig 1000", comments="#")


@pytest.mark.slow
def test_a_package_adds_a_command_a_kind_a_device_and_a_format(tmp_path: Path) -> None:
    target = installed(tmp_path)

    def run(*words: str) -> str:
        return said(target, tmp_path, *words)

    assert "hello" in run("--help")
    assert json.loads(run("hello", "sponge", "--json"))["greeted"] == "sponge"
    write_rig_file(tmp_path / "rig.txt")
    imported = json.loads(run("import", "rig.txt", "--out", "recordings", "--json"))
    assert "soft rig at 1000 Hz" in imported["guess"]
    run("train", "recordings", "--model", "spring", "--out", "rig.spm")
    (tmp_path / "scene.toml").write_text(SCENE)
    run("emit", "--scene", "scene.toml", "--out", "c")
    validated = json.loads(run("validate", "c", "--recording", "recordings", "--json"))
    assert validated["mismatches"] == 0
    felt = json.loads(run("run", "--scene", "c", "--device", "still://3", "--seconds", "0.5",
                          "--log", "felt.h5", "--json"))  # fmt: skip
    assert felt["ticks"] > 0
    log = json.loads(run("validate", "c", "--recording", "felt.h5", "--json"))
    assert log["mismatches"] == 0


def test_what_cannot_be_loaded_is_left_out_and_said(tmp_path: Path) -> None:
    folder = tmp_path / "broken-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[springpot.commands]\nbroken = no_such_module:BROKEN\ntrain = json:loads\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    result = subprocess.run([*CLI, "--help"], env=environment, capture_output=True, text=True,
                            check=True)  # fmt: skip
    left_out = [line for line in result.stderr.splitlines() if "left out" in line]
    assert [("'broken' of broken" in line, "'train' of broken" in line) for line in left_out] == [
        (True, False), (False, True),
    ]  # fmt: skip
    assert "Traceback" not in result.stderr
    assert "train " in result.stdout
