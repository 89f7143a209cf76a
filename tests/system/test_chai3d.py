"""The example of docs/chai3d.md: compiled as it stands, run, and compared with the scene."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from support.paths import ROOT
from support.small import model_file, scene

from springpot.host.emission.emission import emit
from springpot.host.native.compiler import run_compiler
from springpot.host.native.scene_library import SceneLibrary
from springpot.runtime_c.paths import flags


@pytest.fixture(scope="module")
def cxx():
    """A C++ compiler that has its standard library."""
    for name in ("g++", "clang++"):
        if found := shutil.which(name):
            command = [found, "-xc++", "-std=c++17", "-fsyntax-only", "-"]
            if not subprocess.run(command, input=b"#include <chrono>", check=False).returncode:
                return found
    return pytest.skip("no C++ compiler with a standard library")


def test_the_example_in_the_documentation(tmp_path, cxx):
    text = (ROOT / "docs" / "how-to" / "chai3d.md").read_text()
    example = re.findall(r"```cpp\n(.*?)```", text, re.DOTALL)[0]
    assert 35 <= len(example.splitlines()) <= 50
    (tmp_path / "loop.cpp").write_text(example)
    emit(scene(), model_file(tmp_path), tmp_path / "c")
    built = []
    for name in ("sp_scene", "sp_selftest"):
        source, built_file = tmp_path / "c" / f"{name}.c", tmp_path / f"{name}.o"
        run_compiler([*flags("SP_CFLAGS"), "-c", str(source), "-o", str(built_file)])
        built.append(built_file)
    program = tmp_path / "loop"
    warnings = ["-Wall", "-Wextra", "-Werror"]
    subprocess.run(
        [cxx, "-std=c++17", *warnings, f"-I{tmp_path / 'c'}", f"-I{ROOT / 'tests/support/stubs'}",
         tmp_path / "loop.cpp", *built, "-o", program, "-pthread"], check=True)  # fmt: skip
    out = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    lines = [line.split() for line in out.splitlines()]
    state = SceneLibrary(tmp_path / "c").new_state()
    for z, force in lines[:300]:
        if z == "idle":
            expected = state.idle(np.float32(1e-6) * 1000)[0]
        else:
            expected = state.step(-float(z), -0.01)[0]
        assert float(force) == expected
    assert lines[300] == ["0"]
    assert len(lines) == 301
    assert max(float(force) for _, force in lines[:300]) > 1.0
