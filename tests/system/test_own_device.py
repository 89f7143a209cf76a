"""The firmware of docs/how-to/own-device.md: compiled as it stands, and felt through."""

import json
import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support.in_process import spring
from support.paths import ROOT
from support.small import model_file

from springpot.host.native.compiler import run_compiler
from springpot.runtime_c.paths import PORT_WIRE, flags

STUB = ROOT / "tests" / "support" / "stubs" / "own_device.c"


def built(folder: Path) -> Path:
    """The page's C with the stub's hardware."""
    text = (ROOT / "docs" / "how-to" / "own-device.md").read_text()
    (example,) = re.findall(r"```c\n(.*?)```", text, re.DOTALL)
    (folder / "device.c").write_text(example)
    run_compiler([*flags("SP_CFLAGS"), *flags("SP_STRICT"), f"-I{PORT_WIRE}", "-c",
                  str(folder / "device.c"), "-o", str(folder / "device.o")])  # fmt: skip
    program = folder / "device"
    sources = [str(STUB), str(PORT_WIRE / "sp_wire.c"), str(folder / "device.o")]
    run_compiler([*flags("SP_CFLAGS"), f"-I{PORT_WIRE}", *sources, "-o", str(program), "-lm"])
    return program


@contextmanager
def running(program: Path) -> Iterator[str]:
    """The device as a process; its URL."""
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          text=True) as process:  # fmt: skip
        assert process.stdout is not None
        yield process.stdout.readline().strip()
        assert process.stdin is not None
        process.stdin.close()


def test_it_compiles_strictly(tmp_path: Path) -> None:
    assert built(tmp_path).exists()


@pytest.mark.realtime
def test_a_session_on_it_repeats_bit_for_bit(tmp_path: Path) -> None:
    model_file(tmp_path)
    scene, log = tmp_path / "scene.toml", tmp_path / "felt.h5"
    scene.write_text('schema = 1\nname = "x"\nmodel = "model.spm"\n[guard]\nmax_force_n = 10\n')
    emitted = spring("emit", "--scene", scene, "--out", tmp_path / "c")
    assert emitted.returncode == 0, emitted.stderr
    with running(built(tmp_path)) as url:
        done = spring("run", "--scene", tmp_path / "c", "--device", url, "--seconds", 3,
                      "--log", log, "--json")  # fmt: skip
    result = json.loads(done.stdout)
    assert done.returncode == 0, done.stderr
    assert abs(result["ticks"] - 3000) < 30
    assert not result["crc_errors"]
    checked = json.loads(spring("validate", tmp_path / "c", "--recording", log, "--json").stdout)
    assert checked["mismatches"] == 0
