"""Another package's kind and device are used by their names."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.pages.run_pages import run_words
from support.paths import TESTS

from springpot.codegen.errors import DeviceError
from springpot.host.devices import drivers
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.drivers import Driver, open_device

SCENE = 'schema = 1\nname = "rig"\nmodel = "rig.spm"\n[runtime]\nrate_hz = 1000.0\n'


def write_rig_file(path: Path) -> None:
    """Four seconds of pressing a spring that stiffens, and relaxes, at 1 kHz."""
    t_s = np.arange(4000) / 1000
    position_mm = 2.5 * (1 - np.cos(2 * np.pi * t_s))
    force_n = position_mm * (0.8 + 0.05 * position_mm + 0.1 * np.sin(2 * np.pi * t_s))
    columns = np.column_stack([t_s, position_mm, force_n])
    np.savetxt(path, columns, "%.6f", ",", header="time_s,position_mm,force_N", comments="")


@pytest.mark.slow
def test_a_package_adds_a_kind_and_a_device(tmp_path: Path) -> None:
    path = os.pathsep.join([str(tmp_path / "installed"), str(TESTS)])
    (tmp_path / "installed").mkdir()
    install = ["pip", "install", "-e", "tests/support/stranger"]
    run_words(install, tmp_path / "installed", "extend.md")
    write_rig_file(tmp_path / "rig.csv")
    (tmp_path / "scene.toml").write_text(SCENE)
    commands = [
        "import rig.csv --out recordings",
        "train recordings --model spring --out rig.spm",
        "emit --scene scene.toml --out c",
        "validate c --recording recordings --json",
        "run --scene c --device still://3 --seconds 0.5 --log felt.h5 --json",
        "validate c --recording felt.h5 --json",
        "bench --recording recordings --validate recordings --model spring --model rig.spm --json",
    ]
    result = subprocess.run(
        [sys.executable, "-m", "support.in_process", *commands], cwd=tmp_path, text=True,
        env={**os.environ, "PYTHONPATH": path}, capture_output=True, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    printed = filter(lambda line: line.startswith("{"), result.stdout.splitlines())
    validated, felt, log, bench = map(json.loads, printed)
    assert validated["mismatches"] == log["mismatches"] == 0 and felt["ticks"] > 0
    assert {point["model"] for point in bench["points"]} == {"spring", "rig.spm"}


def test_what_cannot_be_loaded_is_left_out_and_said(tmp_path: Path) -> None:
    entries = "[springpot.kinds]\nbroken = no_such_module:BROKEN\nrf-fd = json:loads\n"
    entries += "hammerstein = other:TAKEN\n"
    script = "from springpot.trainer.kinds import KINDS; print(KINDS['hammerstein'].fit, *KINDS)"
    module = "from springpot.trainer.kinds import RBF_FD as TAKEN"
    result = python(beside(tmp_path, entries, module), script)
    left_out = [line for line in result.stderr.splitlines() if "left out" in line]
    names = ("'broken' of other", "'rf-fd' of other", "'hammerstein' of other")
    assert sorted(name for line in left_out for name in names if name in line) == sorted(names)
    assert "rf-fd" in result.stdout.split() and "rbf" not in result.stdout.split()[0]


def beside(folder: Path, entries: str, module: str) -> dict[str, str]:
    """Environment in which a package of one module is installed."""
    info = folder / "other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(entries)
    (folder / "other.py").write_text(module)
    return {**os.environ, "PYTHONPATH": str(folder)}


def python(environment: dict[str, str], script: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True,
                          text=True, check=False)  # fmt: skip


class Mute(OpenedDevice):
    """It has no link, and does not say what its force does unreached."""

    def stop(self) -> None:
        """End nothing."""

    def close(self) -> None:
        """Close nothing."""


@pytest.mark.parametrize(
    ("opens", "told"),
    [
        (Mute, "abstract.*Mute.*link.*unreached"),
        (lambda *_: object(), "object is no OpenedDevice and no VirtualDevice"),
        (lambda _: object(), "takes 1 positional argument but 2 were given"),
        (f"{__name__}:nothing", "no attribute 'nothing'"),
    ],
)
def test_what_a_driver_does_wrong_is_one_line(
    monkeypatch: pytest.MonkeyPatch, opens: Any, told: str
) -> None:
    monkeypatch.setattr(drivers, "drivers", lambda: {"mute": Driver("mute://1", opens)})
    with pytest.raises(DeviceError, match=f"^mute://1: .*{told}.*: correct or uninstall"):
        open_device("mute://1", DeviceRequirements(1000.0, 0.1, 1.0))
