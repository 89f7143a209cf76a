"""The C and C++ of the documents: compiled as they stand, run, and felt through."""

import json
import math
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring
from support.paths import ROOT
from support.small import model_file, scene

from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import run_compiler, shared_library
from springpot.host.devices.wire import Sender, constant
from springpot.host.emission.emission import emit
from springpot.host.native.scene_library import SceneLibrary
from springpot.runtime_c.paths import PORT_WIRE, flags


@pytest.fixture(scope="module")
def cxx():
    """A C++ compiler that has its standard library."""
    for name in ("g++", "clang++"):
        if found := shutil.which(name):
            command = [found, "-xc++", "-std=c++17", "-fsyntax-only", "-"]
            if not subprocess.run(command, input=b"#include <chrono>", check=False).returncode:
                return found
    return pytest.skip("no C++ compiler with a standard library")


def example_of_games(file: str) -> str:
    """Return the C++ that the page of games names so."""
    text = (ROOT / "docs" / "how-to" / "game-engine.md").read_text()
    (example,) = re.findall(rf"```cpp\n(// {file}: .*?)```", text, re.DOTALL)
    return example


FRAMES = """
#include <cstdio>
#include <initializer_list>
int main()
{
    float force_n = 0.0f, last_n = 0.0f;
    for (int rate : {30, 60, 144}) {
        for (Pad pad : {soft, medium, hard}) { /* copies that nothing has pressed */
            for (int picture = 0; picture <= rate; picture++) /* 8 mm in a second */
                force_n = pad.press(1.0f / (float)rate, 0.8f * (float)picture / (float)rate);
            for (float depth_cm : {900.0f, -1e5f, 30.0f, -2000.0f})
                last_n = pad.press(0.5f, depth_cm);
            std::printf("%.4f %.4f\\n", (double)force_n, (double)last_n);
        }
    }
}
"""


def test_the_pads_of_a_game_press_alike_at_any_rate(tmp_path: Path, cxx: str) -> None:
    """The page's class and the ready pad in one unit; a cursor off the screen ends no pad."""
    unity = '#include "soft_pad.c"\n' + example_of_games("pads.cpp") + FRAMES
    (tmp_path / "game.cpp").write_text(unity)
    program, warnings = tmp_path / "game", ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    include = f"-I{ROOT / 'examples' / 'soft_pad'}"
    subprocess.run([cxx, "-std=c++17", *warnings, include, tmp_path / "game.cpp", "-o", program],
                   check=True)  # fmt: skip
    out = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    force_n, away_n = np.array([line.split() for line in out.splitlines()], dtype=float).T
    soft, medium, hard = force_n.reshape(3, 3).T
    np.testing.assert_allclose(soft / medium, 0.4, rtol=1e-3)
    np.testing.assert_allclose(hard / medium, 3.0, rtol=1e-3)
    np.testing.assert_allclose(medium, medium[0], rtol=0.02)
    assert medium[0] > 2.0 and not away_n.any()


def test_the_example_in_the_documentation(tmp_path, cxx):
    example = example_of_games("loop.cpp")
    assert 35 <= len(example.splitlines()) <= 50
    (tmp_path / "loop.cpp").write_text(example)
    emit(scene(), model_file(tmp_path), tmp_path / "c")
    scene_object = tmp_path / "sp.o"
    run_compiler([*flags("SP_CFLAGS"), "-c", str(tmp_path / "c" / "sp.c"), "-o", str(scene_object)])
    program, warnings = tmp_path / "loop", ["-Wall", "-Wextra", "-Werror"]
    subprocess.run(
        [cxx, "-std=c++17", *warnings, f"-I{tmp_path / 'c'}", f"-I{ROOT / 'tests/support/stubs'}",
         tmp_path / "loop.cpp", scene_object, "-o", program, "-pthread"], check=True)  # fmt: skip
    out = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    lines = [line.split() for line in out.splitlines()]
    state = SceneLibrary(tmp_path / "c").new_state()
    for z, force in lines[:300]:
        if z == "idle":
            expected = state.idle(np.float32(1e-6) * 1000)[0]
        else:
            expected = state.step(-float(z), -0.01)[0]
        assert float(force) == expected
    assert lines[300] == ["0"] and len(lines) == 301
    assert max(float(force) for _, force in lines[:300]) > 1.0


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
        yield process.stdout.readline().strip()
        process.stdin.close()


HARNESS = """#include "device.c"
static const uint8_t *line;
static uint32_t left;
static float motor_n;
int device_byte(void) { return left ? (left--, *line++) : -1; }
void device_write(const uint8_t *bytes, uint32_t size) { (void)bytes, (void)size; }
uint32_t device_time_us(void) { return 0; }
void device_motion(float *x, float *v) { *x = *v = 0; }
void device_motor(float force_n) { motor_n = force_n; }
float harness_take(const uint8_t *bytes, uint32_t n);
float harness_take(const uint8_t *bytes, uint32_t n)
{
    line = bytes, left = n;
    device_loop();
    return motor_n;
}
"""


def test_the_device_of_the_page_stops_and_keeps_its_motor_s_limit(tmp_path: Path) -> None:
    """STOP is obeyed whatever else it says; a force beyond the motor's or no number is none."""
    built(tmp_path)
    (tmp_path / "harness.c").write_text(HARNESS)
    library = CLibrary(
        shared_library([tmp_path / "harness.c", PORT_WIRE / "sp_wire.c"], [tmp_path, PORT_WIRE]),
        "float harness_take(const uint8_t *, uint32_t);",
    )
    sender = Sender()

    def take(name: str, **values: float) -> float:
        frame = sender.encode(name, **values)
        return float(
            library.c.harness_take(library.ffi.from_buffer("uint8_t[]", frame), len(frame))
        )

    def command(action: str, rate_hz: float = 1000.0) -> float:
        return take("command", action=constant(action), watchdog_s=0.02, rate_hz=rate_hz)

    command("START")
    assert take("force", force_n=3.0) == 3.0
    assert take("force", force_n=500.0) == 10.0 and take("force", force_n=-500.0) == -10.0
    assert take("force", force_n=math.nan) == 0.0
    assert take("force", force_n=3.0) == 3.0
    assert take("command", action=77, watchdog_s=0.02, rate_hz=1000.0) == 3.0  # refused
    assert command("STOP", rate_hz=0.0) == 0.0
    assert take("force", force_n=3.0) == 0.0


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
    assert abs(result["ticks"] - 3000) < 30 and not result["crc_errors"]
    checked = json.loads(spring("validate", tmp_path / "c", "--recording", log, "--json").stdout)
    assert checked["mismatches"] == 0
