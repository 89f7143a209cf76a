"""CC as other tools take it: a path, or a command of several words such as "ccache gcc"."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.small import model_file, scene

from springpot.codegen.native.compiler import (
    NoCompilerError,
    compiler_reason,
    compiler_version,
    find_compiler,
)
from springpot.host.commands.doctor import examine
from springpot.host.emission.emission import emit

GCC = shutil.which("gcc")


@pytest.fixture(autouse=True)
def _looked_for_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    find_compiler.cache_clear()
    yield
    find_compiler.cache_clear()


@pytest.fixture
def counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A ccache that keeps nothing, and writes down what it was asked to run."""
    tool, log = tmp_path / "bin" / "ccache", tmp_path / "calls"
    tool.parent.mkdir()
    tool.write_text(f'#!/bin/sh\necho "$1" >> {log}\nexec "$@"\n')
    tool.chmod(0o755)
    monkeypatch.setenv("PATH", str(tool.parent), prepend=":")
    monkeypatch.setenv("CC", "ccache gcc")
    return log


@pytest.mark.skipif(GCC is None, reason="no gcc")
def test_a_command_of_two_words_builds_measures_and_is_shown(
    tmp_path: Path, counted: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert find_compiler() == (str(tmp_path / "bin/ccache"), "gcc")
    assert compiler_version(find_compiler()) == compiler_version((str(GCC),))
    emission = emit(scene(), model_file(tmp_path), tmp_path / "c")
    assert emission.footprint.flash_bytes > 1000
    assert counted.read_text().split().count("gcc") >= 3  # version, library, sizes
    row = next(row for row in examine() if row.what == "C compiler")
    assert row.found and "ccache gcc: " in row.seen and row.seen.endswith("(CC names it)")
    monkeypatch.delenv("CC")
    find_compiler.cache_clear()
    assert compiler_reason().startswith("the first of gcc, clang, cc on PATH")


@pytest.mark.parametrize("asked", ["no-such-cc", "no-such-cc gcc", 'gcc "', "''"])
def test_no_such_compiler_is_one_line(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", asked)
    with pytest.raises(NoCompilerError, match="unset CC"):
        find_compiler()
