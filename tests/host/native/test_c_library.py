"""C in this process: what a loaded library may rely on, and whose library is loaded."""

import os
from pathlib import Path

import numpy as np
import pytest

from springpot.codegen.native.c_library import CLibrary, declarations, load_c
from springpot.codegen.native.compiler import CompilerError, cache_folder, shared_library

HEADER = """/* Sums. */
#include <stdint.h>
#include "sp_real.h"
/* springpot declarations begin */
sp_real sum(const sp_real *values, uint32_t n);
/* springpot declarations end */
"""
SOURCE = """#include "sum.h"
sp_real sum(const sp_real *values, uint32_t n)
{
    sp_real total = 0;
    for (uint32_t i = 0; i < n; i++) {
        total += values[i];
    }
    return total;
}
"""


def summing(folder: Path, real: str) -> CLibrary:
    (folder / "sum.h").write_text(HEADER)
    (folder / "sum.c").write_text(SOURCE)
    return load_c([folder / "sum.h"], [folder / "sum.c"], real)


@pytest.mark.parametrize(("real", "dtype"), [("float", np.float32), ("double", np.float64)])
def test_a_header_is_what_python_calls(tmp_path: Path, real: str, dtype: type) -> None:
    library = summing(tmp_path, real)
    values = np.array([1.5, 2.25, -4.0], dtype=dtype)
    assert library.c.sum(library.array(values), 3) == -0.25
    with pytest.raises(TypeError):
        library.c.sum(library.array(np.zeros(3, dtype=np.int32)), 3)
    assert declarations([tmp_path / "sum.h"], real).startswith(f"typedef {real} sp_real;")


ANSWER = "int answer(void);\nint answer(void)\n{\n    return 42;\n}\n"


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "answer.c"
    file.write_text(ANSWER)
    return file


def test_a_folder_of_this_user_alone_is_made_and_used_again(source: Path) -> None:
    usual = os.umask(0o000)
    try:
        library = shared_library([source], [])
    finally:
        os.umask(usual)
    written = library.stat().st_mtime_ns
    assert shared_library([source], []).stat().st_mtime_ns == written
    assert shared_library([source], [], ["-DOTHER"]) != library
    assert cache_folder().stat().st_mode & 0o077 == 0


def test_an_empty_library_is_built_again(source: Path) -> None:
    library = shared_library([source], [])
    library.write_bytes(b"")
    assert CLibrary(shared_library([source], []), "int answer(void);").c.answer() == 42


WHICH = ["folder", "library"]


def parts(library: Path) -> dict[str, Path]:
    return dict(zip(WHICH, (library.parent, library), strict=True))


@pytest.mark.parametrize("mode", [0o720, 0o702])
@pytest.mark.parametrize("which", WHICH)
def test_what_others_can_write_is_not_loaded(which: str, mode: int, source: Path) -> None:
    library = shared_library([source], [])
    library.write_bytes(b"another library")
    parts(library)[which].chmod(mode)
    with pytest.raises(CompilerError, match=r"can be written by others.*set XDG_CACHE_HOME"):
        shared_library([source], [])


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
@pytest.mark.parametrize("which", WHICH)
def test_what_belongs_to_another_user_is_not_loaded(which: str, source: Path) -> None:
    os.chown(parts(shared_library([source], []))[which], 12345, -1)
    with pytest.raises(CompilerError, match="belongs to user 12345"):
        shared_library([source], [])


def test_a_relative_cache_is_ignored(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    assert cache_folder() == tmp_path / ".cache" / "springpot"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "there"))
    assert cache_folder() == tmp_path / "there" / "springpot"
