"""CC as other tools take it: a path, or a command of several words such as "ccache gcc"."""

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.small import model_file, scene

from springpot.host.commands.doctor import examine
from springpot.host.emission.emission import emit
from springpot.host.native.compiler import (
    NoCompilerError,
    compiler_reason,
    compiler_version,
    find_compiler,
)

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
    assert row.found
    assert "ccache gcc: " in row.seen
    assert row.seen.endswith("(CC names it)")
    monkeypatch.delenv("CC")
    find_compiler.cache_clear()
    assert compiler_reason().startswith("the first of gcc, clang, cc on PATH")


def test_a_path_with_a_space_is_one_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiler = tmp_path / "my tools" / "cc"
    compiler.parent.mkdir()
    compiler.write_text("#!/bin/sh\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    assert find_compiler() == (str(compiler),)
    assert compiler_version(find_compiler()) == f"{compiler}, of no known version"


@pytest.mark.parametrize("asked", ["no-such-cc", "no-such-cc gcc", 'gcc "', "''"])
def test_no_such_compiler_is_one_line(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", asked)
    with pytest.raises(NoCompilerError, match="unset CC"):
        find_compiler()


@pytest.mark.skipif(GCC is None, reason="no gcc")
def test_the_compiler_of_an_extra_serves_where_there_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A package of that name which hands on to gcc; `.ci/wheel` tries the real one."""
    package = tmp_path / "packages" / "ziglang"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(
        f"import subprocess, sys\nassert sys.argv[1] == 'cc'\n"
        f"sys.exit(subprocess.call(['{GCC}', *sys.argv[2:]]))\n"
    )
    linker = Path(str(shutil.which("ld")))
    (tmp_path / "bin").mkdir()
    for tool in (linker, linker.with_name("as")):
        (tmp_path / "bin" / tool.name).symlink_to(tool)
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    with pytest.raises(NoCompilerError, match=r"pip install 'springpot\[cc\]'"):
        find_compiler()
    monkeypatch.syspath_prepend(package.parent)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    assert find_compiler() == (sys.executable, "-P", "-m", "ziglang", "cc")
    emission = emit(scene(), model_file(tmp_path), tmp_path / "c")
    assert emission.footprint is None
    assert "no `size` on PATH" in emission.notices[0]
    row = next(row for row in examine() if row.what == "C compiler")
    assert "of springpot[cc]: there is no gcc" in row.seen
