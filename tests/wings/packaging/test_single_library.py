"""A scene in one file as a library: its metadata, the Arduino sketch in a stand-in, the example."""

import json
import re
import shutil
import subprocess
from itertools import pairwise
from pathlib import Path

import pytest
from support.c import golden_forces
from support.c.single import plan_of, write_single
from support.paths import TESTS

from springpot.codegen.plan.plan import Plan

STAND_IN = TESTS / "support" / "arduino"
# The Arduino library specification: required, and the categories it knows.
REQUIRED = ["name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url"]
CATEGORIES = {"Display", "Communication", "Signal Input/Output", "Sensors", "Device Control",
              "Timing", "Data Storage", "Data Processing", "Other"}  # fmt: skip
TOOL = shutil.which("g++")


def eco(number: str = "float32", velocity: str = "estimate") -> Plan:
    model = golden_forces.model("hammerstein")
    return plan_of("eco", model, number, "off" if velocity == "estimate" else "tool",
                   velocity=velocity)  # fmt: skip


def sketch_run(folder: Path, source: Path, options: tuple[str, ...] = ()) -> list[list[int]]:
    """What the sketch wrote to its pin over a second of presses: rows of microseconds and duty."""
    name = source.stem
    program = folder / "sketch"
    sketch = folder / "examples" / f"{name}_loop" / f"{name}_loop.ino"
    (folder / "object.o").unlink(missing_ok=True)
    subprocess.run(["gcc", "-O2", "-c", source, "-o", folder / "object.o"], check=True)
    command = ["g++", "-std=gnu++17", "-Wall", "-Wextra", "-Wconversion", "-Werror", *options,
               f"-I{STAND_IN}", f"-I{folder}", "-include", "Arduino.h", "-x", "c++", str(sketch),
               str(STAND_IN / "board.cpp"), "-x", "none", str(folder / "object.o"), "-lm",
               "-o", str(program)]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    said = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    return [[int(word) for word in line.split()] for line in said.splitlines() if line[0].isdigit()]


def test_library_properties_keep_to_the_specification(tmp_path: Path) -> None:
    source = write_single(eco(), tmp_path)
    lines = (tmp_path / "library.properties").read_text().splitlines()
    properties = dict(line.split("=", 1) for line in lines)
    assert list(properties) == [*REQUIRED, "architectures", "includes"]
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}", properties["name"])
    assert re.fullmatch(r"\d+\.\d+\.\d+", properties["version"])
    assert properties["category"] in CATEGORIES
    assert properties["includes"] == source.with_suffix(".h").name
    # A flat layout: what lies in the root is compiled, so that there is one source and no main.
    source.with_suffix(".cpp").unlink()
    assert [file.name for file in tmp_path.glob("*.c*")] == ["eco.c"]
    sketch = tmp_path / "examples" / "eco_loop" / "eco_loop.ino"
    assert sketch.exists(), "a sketch has its folder's name"


@pytest.mark.parametrize("velocity", ["estimate", "given"])
def test_the_module_definition_names_what_the_library_exports(
    tmp_path: Path, velocity: str
) -> None:
    """What gcc exports by itself, Visual Studio has to be given."""
    write_single(eco(velocity=velocity), tmp_path)
    library = tmp_path / "eco.so"
    command = ["gcc", "-shared", "-fPIC", "-o", library, tmp_path / "eco.c", "-lm"]
    subprocess.run(command, check=True)
    symbols = subprocess.run(["nm", "-D", library], check=True, capture_output=True, text=True)
    exported = set(re.findall(r" T (\w+)$", symbols.stdout, re.MULTILINE))
    head, *names = (tmp_path / "eco.def").read_text().split()
    assert head == "EXPORTS"
    assert len(names) == len(set(names)) > 5
    assert set(names) == exported


def test_platformio_builds_one_source(tmp_path: Path) -> None:
    write_single(plan_of("my-soft-one", golden_forces.model("hammerstein"), "float32", "off"),
                 tmp_path)  # fmt: skip
    found = json.loads((tmp_path / "library.json").read_text())
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", found["name"]) and len(found["name"]) <= 50
    assert re.fullmatch(r"\d+\.\d+\.\d+", found["version"])
    assert len(found["description"]) <= 255
    assert all(re.fullmatch(r"[a-z\d\-\+\. ]+", word) for word in found["keywords"])
    assert found["frameworks"] == found["platforms"] == "*"
    assert (tmp_path / found["headers"]).exists()
    build = found["build"]
    assert build["srcDir"] == build["includeDir"] == "."  # no folder src: all of them without this
    pattern = build["srcFilter"][0].removeprefix("+<").removesuffix(">")
    assert {file.name for file in tmp_path.glob(pattern)} == {"my_soft_one.c", "my_soft_one.cpp"}


@pytest.mark.skipif(TOOL is None, reason="no g++")
@pytest.mark.parametrize("velocity", ["estimate", "device"])
@pytest.mark.parametrize("number", ["float32", "float64"])
def test_the_sketch_renders(tmp_path: Path, number: str, velocity: str) -> None:
    """A press of 0.2 s, then a stall of 5 ms, then one of 100 ms: the watchdog latches."""
    rows = sketch_run(tmp_path, write_single(eco(number, velocity), tmp_path))
    assert rows[0] == [0, 0]
    ticks = [row[0] for row in rows[1:]]
    assert {b - a for a, b in pairwise(ticks[:190])} == {1000}
    duties = [row[1] for row in rows]
    assert max(duties[:200]) > 20 and max(duties) <= 255
    before, after = (next(row for row in rows if row[0] >= at) for at in (299_000, 306_000))
    assert before[1] > 20 and after[1] > 20, "a short stall is made up for"
    assert {row[1] for row in rows if row[0] > 600_000} == {0}, "the watchdog latched"


@pytest.mark.skipif(TOOL is None, reason="no g++")
def test_the_sketch_without_a_passed_selftest_has_no_force(tmp_path: Path) -> None:
    source = write_single(eco(), tmp_path)
    text = source.read_text()
    at = text.index("golden_force[")
    source.write_text(text[:at] + text[at:].replace("    0x0u,", "    0x1u,", 1))
    assert {row[1] for row in sketch_run(tmp_path, source)} == {0}


def test_the_example_in_c_renders_lines(tmp_path: Path) -> None:
    source = write_single(eco(), tmp_path)
    main = tmp_path / "examples" / "eco_lines" / "main.c"
    command = ["gcc", "-O2", f"-I{tmp_path}", source, main, "-o", tmp_path / "lines", "-lm"]
    subprocess.run(command, check=True)
    done = subprocess.run([tmp_path / "lines"], input="0\n0.001\n0.002\n", capture_output=True,
                          text=True, check=True)  # fmt: skip
    forces = [float(line.split()[0]) for line in done.stdout.splitlines()]
    assert forces[0] == 0.0 < forces[2]
