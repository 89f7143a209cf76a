"""The checks themselves: what fails in one of them is an exit status."""

import importlib
import subprocess
from pathlib import Path

import pytest
from support.paths import ROOT


def program(file: Path, text: str = "") -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return file


def made(target: str, folder: Path, cwd: Path = ROOT, **variables: object) -> int:
    """Exit status of a target; programs that it builds and installs are those of the folder."""
    given = {"COMPILERS": "gcc", "C_BUILD": folder / "c", "STAMP": program(folder / "stamp"),
             "C_TESTS": "tests/c/test_patterns.c tests/c/test_range.c", **variables}  # fmt: skip
    command = ["make", target, *(f"{name}={value}" for name, value in given.items())]
    return subprocess.run(command, cwd=cwd, capture_output=True, check=False).returncode


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


@pytest.mark.parametrize("text", ["int x;\n", "int   x ;\n"])
def test_c_that_is_not_formatted_fails(tmp_path: Path, text: str) -> None:
    for name in ("Makefile", "runtime_c/flags.mk", "requirements.lock", "pyproject.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    (tmp_path / "runtime_c/x.c").write_text(text)
    subprocess.run("git init -q && git add .", shell=True, cwd=tmp_path, check=True)
    status = made("format", tmp_path, tmp_path, BIN=ROOT / ".venv/bin")
    assert bool(status) is (text != "int x;\n")


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
