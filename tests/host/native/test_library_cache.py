"""The cache of built libraries: only what this user alone can have written is loaded."""

import hashlib
import os
from pathlib import Path

import pytest

from springpot.host.native.compiler import CompilerError, cache_folder, shared_library

SOURCE = "int answer(void);\nint answer(void)\n{\n    return 42;\n}\n"


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file = tmp_path / "answer.c"
    file.write_text(SOURCE)
    return file


def test_a_folder_of_this_user_alone_is_made_and_used_again(source: Path) -> None:
    usual = os.umask(0o000)
    try:
        library = shared_library([source], [])
    finally:
        os.umask(usual)
    written = library.stat().st_mtime_ns
    assert shared_library([source], []).stat().st_mtime_ns == written
    assert cache_folder().stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("which", ["folder", "library", "checksum"])
def test_what_others_can_write_is_not_loaded(which: str, source: Path) -> None:
    library = shared_library([source], [])
    planted = b"another library"
    library.write_bytes(planted)
    library.with_suffix(".sha256").write_text(hashlib.sha256(planted).hexdigest())
    paths = {"folder": library.parent, "library": library,
             "checksum": library.with_suffix(".sha256")}  # fmt: skip
    paths[which].chmod(0o777)
    with pytest.raises(CompilerError, match=r"can be written by others.*set XDG_CACHE_HOME"):
        shared_library([source], [])


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
@pytest.mark.parametrize("which", ["folder", "library", "checksum"])
def test_what_belongs_to_another_user_is_not_loaded(which: str, source: Path) -> None:
    library = shared_library([source], [])
    paths = {"folder": library.parent, "library": library,
             "checksum": library.with_suffix(".sha256")}  # fmt: skip
    os.chown(paths[which], 12345, -1)
    with pytest.raises(CompilerError, match="belongs to user 12345"):
        shared_library([source], [])
