"""Files and folders that nobody ever sees half of."""

import os
from pathlib import Path

import pytest

from springpot.codegen.files import atomic_write, write_file, write_folder_atomically


@pytest.mark.parametrize("options", [{}, {"overwrite": False}, {"durable": True}])
def test_a_write_that_fails_leaves_nothing_aside(tmp_path: Path, options: dict[str, bool]) -> None:
    def write(path: Path) -> None:
        with atomic_write(path, **options) as aside:
            aside.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space") as failed:
        write(tmp_path / "a")
    assert failed.value.filename == str(tmp_path / "a") and list(tmp_path.iterdir()) == []


def test_the_old_content_stands_until_the_new_one_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "a"
    write_file(path, b"old")
    with atomic_write(path) as aside:
        aside.write_bytes(b"new")
        assert path.read_bytes() == b"old"
        assert aside.parent == path.parent  # renamed within one file system
    assert path.read_bytes() == b"new" and list(tmp_path.iterdir()) == [path]


def test_a_file_that_came_meanwhile_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "a"

    def write() -> None:
        with atomic_write(path, overwrite=False) as aside:
            aside.write_text("ours")
            path.write_text("theirs")

    with pytest.raises(FileExistsError):
        write()
    assert path.read_text() == "theirs" and list(tmp_path.iterdir()) == [path]


def test_what_is_to_last_is_on_the_disk_before_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Content, name, folder: in that order."""
    path, calls = tmp_path / "a", []
    sync = os.fsync

    def recording_sync(descriptor: int) -> None:
        calls.append((Path(f"/proc/self/fd/{descriptor}").readlink(), path.exists()))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", recording_sync)
    with atomic_write(path, durable=True) as aside:
        aside.write_text("new")
    assert calls == [(aside, False), (tmp_path, True)]
    calls.clear()
    write_file(path, b"quick")
    assert calls == []


def test_a_folder_is_replaced_whole_or_not_at_all(tmp_path: Path) -> None:
    folder = tmp_path / "c"

    def make(name: str, fails: bool) -> None:
        with write_folder_atomically(folder) as aside:
            aside.mkdir()
            (aside / name).touch()
            if fails:
                raise ValueError("refused")

    make("first", fails=False)
    with pytest.raises(ValueError, match="refused"):
        make("second", fails=True)
    assert [file.name for file in folder.iterdir()] == ["first"]
    make("third", fails=False)
    assert [file.name for file in folder.iterdir()] == ["third"]
    assert list(tmp_path.iterdir()) == [folder]
