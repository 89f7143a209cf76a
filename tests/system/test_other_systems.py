"""Commands without what Windows and macOS lack, and without extras: what is required is enough."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.pages.job import small_job
from support.paths import TESTS, ZIG

from springpot.runtime_c.paths import (
    INCLUDE,
    PORT_FIT,
    PORT_POSIX,
    PORT_TESTBENCH,
    PORT_WIRE,
    SIM,
    SOURCE,
    flags,
)

MINGW = "x86_64-w64-mingw32-gcc"

# Without the modules of the first argument; with those of Unix, their attributes go.
WITHOUT = """
import os, runpy, signal, socket, sys
absent = sys.argv.pop(1).split()
sys.modules.update(dict.fromkeys(absent))
for module, names in ((os, ("geteuid", "sched_getaffinity")), (signal, ("SIGHUP", "SIGQUIT")),
                      (socket, ("AF_CAN", "AF_UNIX"))):
    for name in names:
        if "fcntl" in absent and hasattr(module, name):
            delattr(module, name)
runpy.run_module("support.in_process", run_name="__main__")
"""
UNIX = "fcntl resource termios tty"
EXTRAS = "scipy sklearn joblib matplotlib can m2cgen statsmodels"
COMMANDS = {  # what is not there: commands that do without
    f"{UNIX} {EXTRAS} serial": [
        "import a.csv --out imported",
        "check training",
        "emit --scene scene.toml --out c",
        "build c",
        "validate c --recording validation",
        "stability --scene scene.toml",
    ],
    UNIX: [
        "record --device sim://ecoflex-00-10 --protocol paper --out simulated",
        "train training --model hammerstein --out m.spm",
        "report c",
    ],
    EXTRAS: ["run --scene scene.toml --device sim://ecoflex-00-30 --seconds 0.5 --log felt.h5"],
    f"{EXTRAS} serial": ["validate c --recording felt.h5"],
}


def run(folder: Path, absent: str, lines: list[str]) -> subprocess.CompletedProcess[str]:
    """Commands in one process, until one fails."""
    command = [sys.executable, "-c", WITHOUT, absent, *lines]
    environment = {**os.environ, "PYTHONPATH": str(TESTS)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True,
                          check=False)  # fmt: skip


@pytest.mark.slow
def test_commands_need_neither_unix_nor_what_is_not_required(tmp_path: Path) -> None:
    small_job(tmp_path)
    rows = "".join(f"{k / 100},{k % 50},{k % 50}\n" for k in range(300))
    (tmp_path / "a.csv").write_text(f"time_s,position_mm,force_N\n{rows}")
    for absent, lines in COMMANDS.items():
        done = run(tmp_path, absent, lines)
        assert done.returncode == 0, done.stderr


def test_a_module_of_another_system_is_not_to_be_installed(tmp_path: Path) -> None:
    done = run(tmp_path, UNIX, ["run --scene none.toml --device serial:///dev/none"])
    assert done.returncode != 0 and "pip install" not in done.stderr
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


def compiled(folder: Path, real: str, compiler: list[str], options: list[str]) -> list[Path]:
    """Objects of loop, links, simulated bench and checks: what is built on first use."""
    folders = [PORT_POSIX, PORT_WIRE, PORT_TESTBENCH, SIM]
    folders += [PORT_FIT, SOURCE] if real == "double" else []
    include = [f"-I{at}" for at in (*folders, INCLUDE, INCLUDE / real)]
    objects = []
    for source in (file for at in folders for file in sorted(at.glob("*.c"))):
        objects.append(folder / f"{source.stem}.o")
        command = [*compiler, *flags("SP_CFLAGS"), *options, *include, "-c", source, "-o"]
        done = subprocess.run([*command, objects[-1]], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    return objects


@pytest.mark.slow
@pytest.mark.skipif(shutil.which(MINGW) is None, reason="no mingw: gcc-mingw-w64-x86-64-win32")
@pytest.mark.parametrize("real", ["float", "double"])
def test_the_c_of_a_pc_compiles_for_windows(tmp_path: Path, real: str) -> None:
    """Not under SP_STRICT: mingw's own isfinite converts."""
    assert compiled(tmp_path, real, [MINGW], ["-Wall", "-Wextra", "-Werror"])


@pytest.mark.few(0, 2)  # slow: a Mac of today; mingw's compiles for Windows above
@pytest.mark.skipif(not ZIG.exists(), reason="no zig: make build/zig/ziglang/zig")
@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("system", ["macos", "windows-gnu"])
@pytest.mark.parametrize("processor", ["aarch64", "x86_64"])
def test_the_c_of_a_pc_is_strict_elsewhere(
    tmp_path: Path, processor: str, system: str, real: str
) -> None:
    zig = [str(ZIG), "cc", "-target", f"{processor}-{system}"]
    objects = compiled(tmp_path, real, zig, flags("SP_STRICT"))
    if system == "macos":  # a library for Windows takes minutes: zig makes that of the system first
        library = tmp_path / "library.dylib"
        subprocess.run([*zig, *flags("SP_SHARED"), *objects, "-o", library], check=True)
