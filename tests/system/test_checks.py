"""The checks themselves: what fails in one of them is an exit status."""

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.paths import ROOT


def program(file: Path, text: str = "") -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return file


def made(target: str, folder: Path, **variables: object) -> int:
    """Exit status of a target; programs that it builds and installs are those of the folder."""
    given = {"COMPILERS": "gcc", "C_BUILD": folder / "c", "STAMP": program(folder / "stamp"),
             "C_TESTS": "tests/c/test_patterns.c tests/c/test_range.c", **variables}  # fmt: skip
    command = ["make", target, *(f"{name}={value}" for name, value in given.items())]
    return subprocess.run(command, cwd=ROOT, capture_output=True, check=False).returncode


@pytest.mark.parametrize("fails", ["none", "patterns", "scene", "wire"])
def test_a_program_of_c_or_a_fuzzer_that_fails_ends_the_target(tmp_path: Path, fails: str) -> None:
    for real in ("float", "double"):
        for name in ("patterns", "range"):
            program(tmp_path / f"c/gcc/{real}/test_{name}", f"exit {int(name == fails)}")
    for name in ("pip", "pytest"):
        program(tmp_path / "bin" / name)
    program(tmp_path / "bin/python", f"test $2 != {fails}")
    assert bool(made("test-c", tmp_path)) is (fails == "patterns")
    assert bool(made("soak", tmp_path, BIN=tmp_path / "bin")) is (fails != "none")


@pytest.mark.parametrize("same", [True, False])
def test_two_builds_of_other_bytes_are_no_distribution(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, same: bool
) -> None:
    monkeypatch.syspath_prepend(ROOT / ".ci")
    dist = importlib.import_module("dist")

    def built(_scratch: Path, out: Path) -> list[Path]:
        return [program(out / "x.whl", "" if same else out.name)]

    monkeypatch.setattr(dist, "distributions", built)
    monkeypatch.setattr("sys.argv", ["dist.py", str(tmp_path / "dist")])
    assert (dist.main(), (tmp_path / "dist").exists()) == (int(not same), same)


@pytest.mark.parametrize(
    "fails", ["nothing", "demo", ".venv/installed", "check", "packages", "rest"]
)
def test_a_change_passes_if_every_part_of_ci_does(tmp_path: Path, fails: str) -> None:
    """`.ci/run` in a copy, with git, make and the packages' check replaced by their status."""
    (tmp_path / ".ci").mkdir()
    program(tmp_path / ".ci/run").write_bytes((ROOT / ".ci/run").read_bytes())
    program(tmp_path / ".ci/packages", f"test {fails} != packages")
    program(tmp_path / "bin/git", 'mkdir -p "$4"')
    program(tmp_path / "bin/id", "echo 1000")
    program(tmp_path / "bin/make", f'case "$*" in *{fails}*) exit 1;; esac')
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}",
                   "TMPDIR": str(tmp_path)}  # fmt: skip
    done = subprocess.run([tmp_path / ".ci/run"], env=environment, capture_output=True, check=False)
    assert bool(done.returncode) is (fails != "nothing"), done.stderr


@pytest.mark.parametrize("licence", ["GNU General Public License v3 (GPLv3)", "MIT License"])
def test_a_copyleft_licence_is_refused(tmp_path: Path, licence: str) -> None:
    """pip-licenses, with the options that .ci/packages gives it, of a package with that licence."""
    facts = f"Metadata-Version: 2.1\nName: given\nVersion: 1\nLicense: {licence}\n"
    program(tmp_path / "given-1.dist-info/METADATA").write_text(facts)
    (options,) = re.findall(r"(--from=mixed.*?) >", (ROOT / ".ci/packages").read_text(), re.DOTALL)
    command = f"{sys.executable} -m piplicenses --packages=given {options}"
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, shell=True, env=environment, capture_output=True, check=False)
    assert bool(done.returncode) is ("GPL" in licence), done.stderr
