"""Run the commands that need no hardware without what Windows and macOS lack."""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.small import training

from springpot import write_recordings

# Modules and attributes that those systems' Python has not.
WITHOUT = """
import os, signal, socket, sys
for name in ("fcntl", "resource", "termios", "tty"):
    sys.modules[name] = None
for module, names in ((os, ("geteuid", "sched_getaffinity")), (signal, ("SIGHUP", "SIGQUIT")),
                      (socket, ("AF_CAN", "AF_UNIX"))):
    for name in names:
        if hasattr(module, name):
            delattr(module, name)
from springpot.host.cli import main
sys.argv[0] = "springpot"
main()
"""


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", WITHOUT, *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_commands_without_hardware_need_none_of_it(tmp_path: Path) -> None:
    write_recordings(tmp_path / "rec", training()[:4])
    (tmp_path / "a.csv").write_text(
        "time_s,position_mm,force_N\n"
        + "".join(f"{k / 100},{k % 50},{k % 50}\n" for k in range(300))
    )
    for line in (
        "import a.csv --out imported",
        "record --device sim://ecoflex-00-10 --protocol paper --out simulated",
        "check rec",
        "train rec --model hammerstein --out m.spm",
        "emit --model m.spm --out c",
        "build c",
        "validate c --recording rec",
        "report c",
        "stability --model m.spm",
    ):
        done = run(tmp_path, *line.split())
        assert done.returncode == 0, (line, done.stderr)


def test_a_module_of_another_system_is_not_to_be_installed(tmp_path: Path) -> None:
    done = run(tmp_path, "run", "--scene", "none.toml", "--device", "serial:///dev/none")
    assert done.returncode != 0
    assert "pip install" not in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_no_module_of_the_folder_is_run(tmp_path: Path) -> None:
    """A process that reads arrays once ran whatever json.py lay beside the file."""
    for name in ("json", "struct", "zipfile", "resource", "numpy", "h5py"):
        (tmp_path / f"{name}.py").write_text("open('ran', 'w')\n")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for channel, values in (("time_s", 0.01), ("position_mm", 0.1), ("force_N", 0.2)):
            file[channel] = values * np.arange(200.0)
    command = [sys.executable, "-P", "-c", "from springpot.host.cli import main; main()"]
    done = subprocess.run([*command, "import", "a.h5", "--out", "out"], cwd=tmp_path,
                          capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "ran").exists()
