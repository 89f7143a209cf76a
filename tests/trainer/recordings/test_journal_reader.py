"""What a journal gives back, block by block: files made here, no process that dies."""

import dataclasses
import fcntl
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.messages import require_line

from springpot.codegen.errors import DataError
from springpot.trainer.recordings import journal_reader
from springpot.trainer.recordings.journal_blocks import (
    BLOCK_BYTES,
    LAST_METADATA,
    METADATA,
    SAMPLES,
    encode,
)
from springpot.trainer.recordings.journal_reader import read_journal, read_parts

ROWS = 5
BLOCK_S = 0.25
METADATA_OF = {
    "schema": 1, "name": "pad", "dt_s": 0.05, "source": "sim://x", "details": {"k": 1},
    "block_s": BLOCK_S, "zero": "first",
}  # fmt: skip
BAD = None


def rows(k: int, count: int = ROWS, width: int = 2) -> np.ndarray:
    """Samples of the k-th block, all different."""
    return np.arange(float(count * width)).reshape(count, width) * 1e-4 + k


def journal(
    folder: Path, blocks: Sequence[np.ndarray | None], number: int = 7, **changes: Any
) -> Path:
    """A journal of these blocks of samples, BAD ones damaged; changes: of its metadata."""
    text = json.dumps(METADATA_OF | changes).encode()
    content = encode(number, 0, LAST_METADATA, text)
    for k, block in enumerate(blocks, 1):
        if block is BAD:
            content += encode(number, k, SAMPLES, b"")[:-1] + b"\x01"
        else:
            content += encode(number, k, SAMPLES, block.tobytes())
    path = folder / "pad.journal"
    path.write_bytes(content)
    return path


def good(count: int, first: int = 0) -> list[np.ndarray | None]:
    return [rows(k) for k in range(first, first + count)]


def refused(path: Path, of_parts: bool = False) -> str:
    with pytest.raises(DataError) as found:
        read_parts(path) if of_parts else read_journal(path)
    assert "\n" not in str(found.value)
    return str(found.value)


def test_a_whole_journal_is_the_recording(tmp_path: Path) -> None:
    found = read_journal(journal(tmp_path, good(3)))
    expected = np.concatenate([rows(k) for k in range(3)])
    recording = found.recording
    np.testing.assert_array_equal(recording.position_m, expected[:, 0])
    np.testing.assert_array_equal(recording.force_n, expected[:, 1])
    assert recording.position_m.dtype == np.float64
    assert recording.position_m.flags.c_contiguous
    assert (recording.name, recording.dt_s, recording.zero) == ("pad", 0.05, "first")
    assert (recording.source, recording.details) == ("sim://x", {"k": 1})
    assert recording.channels == {}
    assert found.lost == ""
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.lost = "nothing"  # type: ignore[misc]  # what is asked


def test_channels_are_the_columns_after_position_and_force(tmp_path: Path) -> None:
    block = rows(0, width=4)
    found = read_journal(journal(tmp_path, [block], channels=["notes", "late"])).recording
    assert list(found.channels) == ["notes", "late"]
    np.testing.assert_array_equal(found.channels["notes"], block[:, 2])
    np.testing.assert_array_equal(found.channels["late"], block[:, 3])


@pytest.mark.parametrize(
    ("ends", "block_s", "lost_s"),
    [
        ([BAD], BLOCK_S, BLOCK_S),
        ([BAD] * 4, BLOCK_S, 1.0),
        ([rows(9).ravel()[:5]], BLOCK_S, BLOCK_S),  # no whole number of rows, its checksum right
        ([BAD], None, 0.05),  # of an older version: a block may be of one sample
        *(([BAD] * 3, 1.0 / 3 + above_s, 1.0) for above_s in (0.0, 1e-10, 0.9e-9 / 3)),
    ],
)
def test_up_to_a_second_may_be_lost_at_the_end(
    tmp_path: Path, ends: list[np.ndarray | None], block_s: float | None, lost_s: float
) -> None:
    found = read_journal(journal(tmp_path, [*good(2), *ends], block_s=block_s))
    assert len(found.recording.position_m) == 2 * ROWS
    assert found.lost == f", up to {lost_s:.3f} s at its end are lost"


@pytest.mark.parametrize("block_s", [1.0 / 3 + 1.1e-9 / 3, 0.4])
def test_more_than_a_second_at_the_end_is_refused(tmp_path: Path, block_s: float) -> None:
    path = journal(tmp_path, [*good(2), *[BAD] * 3], block_s=block_s)
    require_line(refused(path), path, "3 of 5", f"{2 * block_s:.3f} s", "springpot import")


def test_a_hole_before_whole_blocks_is_refused(tmp_path: Path) -> None:
    path = journal(tmp_path, [rows(0), BAD, rows(2), BAD])
    require_line(refused(path), path, "2 of 4", "0.250 s")
    path = journal(tmp_path, [BAD, *good(2)])
    require_line(refused(path), path, "1 of 3", "0.000 s")


def test_no_samples_is_refused(tmp_path: Path) -> None:
    for blocks in ([], [BAD], [rows(0, count=1)], [np.zeros((0, 2))]):
        path = journal(tmp_path, blocks)
        for of_parts in (False, True):
            require_line(refused(path, of_parts), path, "interrupted", "remove it")
    assert len(read_journal(journal(tmp_path, [rows(0, count=2)])).recording.position_m) == 2


@pytest.mark.parametrize("what", ["empty", "damaged", "samples first", "never ends"])
def test_without_its_metadata_it_is_refused(tmp_path: Path, what: str) -> None:
    path = journal(tmp_path, good(2))
    content = path.read_bytes()
    text = json.dumps(METADATA_OF).encode()
    path.write_bytes(
        {
            "empty": b"",
            "damaged": b"x" + content[1:],
            "samples first": encode(7, 0, SAMPLES, rows(0).tobytes())
            + encode(7, 1, LAST_METADATA, text)
            + encode(7, 2, SAMPLES, rows(1).tobytes()),
            "never ends": encode(7, 0, METADATA, text),
        }[what]
    )
    require_line(refused(path), path, "very start", "first block", "remove it")


def test_metadata_may_take_several_blocks(tmp_path: Path) -> None:
    text = json.dumps(METADATA_OF | {"details": {"note": "long"}}).encode()
    path = tmp_path / "pad.journal"
    blocks = [
        encode(7, 0, METADATA, text[:30]),
        encode(7, 1, METADATA, text[30:60]),
        encode(7, 2, LAST_METADATA, text[60:]),
        encode(7, 3, SAMPLES, rows(0).tobytes()),
        encode(7, 4, LAST_METADATA, text[:10]),  # no samples: damage, like any other kind
    ]
    path.write_bytes(b"".join(blocks))
    found = read_journal(path)
    assert found.recording.details == {"note": "long"}
    assert len(found.recording.position_m) == ROWS
    assert found.lost == ", up to 0.250 s at its end are lost"
    path.write_bytes(b"".join([blocks[0], blocks[1][:-1] + b"\0", *blocks[2:]]))
    assert "interrupted at its very start" in refused(path)


def test_blocks_elsewhere_of_another_journal_or_cut_are_damage(tmp_path: Path) -> None:
    path = journal(tmp_path, good(4))
    content = path.read_bytes()
    blocks = [content[k : k + BLOCK_BYTES] for k in range(0, len(content), BLOCK_BYTES)]
    for last in (encode(8, 4, SAMPLES, rows(4).tobytes()), blocks[3], blocks[4][:-1]):
        path.write_bytes(b"".join([*blocks[:4], last]))
        found = read_journal(path)
        assert len(found.recording.position_m) == 3 * ROWS
        assert found.lost == ", up to 0.250 s at its end are lost"
    path.write_bytes(b"".join([blocks[0], blocks[2], *blocks[2:]]))
    assert "1 of 4 blocks of samples are damaged" in refused(path)


def test_samples_that_no_recording_may_have_name_the_file(tmp_path: Path) -> None:
    block = rows(0)
    block[2, 1] = np.nan
    path = journal(tmp_path, [block])
    assert refused(path).startswith(f"{path}: ")
    assert refused(path, of_parts=True).startswith(f"{path}: ")


def test_a_file_that_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    gone = tmp_path / "gone.journal"
    require_line(refused(gone), gone, "No such file")
    assert str(tmp_path) in refused(tmp_path)
    pipe = tmp_path / "pipe.journal"
    os.mkfifo(pipe)
    assert str(pipe) in refused(pipe)


def test_parts_are_cut_at_the_holes(tmp_path: Path) -> None:
    (whole,), found = read_parts(journal(tmp_path, good(3)))
    assert (whole.name, len(whole.position_m)) == ("pad", 3 * ROWS)
    require_line(found, "interrupted", "3 blocks")
    blocks = [*good(2), BAD, BAD, *good(1, first=4), BAD]
    parts, found = read_parts(journal(tmp_path, blocks))
    assert [part.name for part in parts] == ["pad-part1", "pad-part2"]
    assert [len(part.position_m) for part in parts] == [2 * ROWS, ROWS]
    np.testing.assert_array_equal(parts[1].force_n, rows(4)[:, 1])
    require_line(found, "6 blocks", "3 damaged", "0.500 s, 0.750 s, 1.250 s", "2 parts")
    for holes, more in ((5, ""), (6, ", ...")):
        _, found = read_parts(journal(tmp_path, [*good(1), *[BAD] * holes]))
        assert f"0.750 s, 1.000 s, 1.250 s{more}), cut there into 1 parts" in found


def test_a_part_of_one_sample_is_none(tmp_path: Path) -> None:
    (only,), found = read_parts(journal(tmp_path, [BAD, rows(1, 1), BAD, rows(3, 2)]))
    assert only.name == "pad"
    np.testing.assert_array_equal(only.position_m, rows(3, 2)[:, 0])
    assert "2 damaged and left out (from 0.000 s, 0.500 s), cut there into 1 parts" in found
    path = journal(tmp_path, [rows(0, 1), BAD, rows(2, 1)])
    require_line(refused(path, of_parts=True), path, "no whole block")


def test_the_journal_of_a_recording_lies_beside_it() -> None:
    assert journal_reader.journal_of(Path("a/b.h5")) == Path("a/b.journal")
    assert journal_reader.journal_of(Path("a/b.c")) == Path("a/b.c.journal")


def test_a_journal_that_is_locked_is_being_recorded(tmp_path: Path) -> None:
    path = journal(tmp_path, good(1))
    assert not journal_reader.is_being_recorded(path)
    with path.open("r+b") as writer:
        fcntl.flock(writer, fcntl.LOCK_EX | fcntl.LOCK_NB)
        free = os.dup(writer.fileno())
        os.close(free)
        assert journal_reader.is_being_recorded(path)
        assert os.dup(writer.fileno()) == free  # the lowest that is free: it left none open
        os.close(free)
    assert not journal_reader.is_being_recorded(path)


def test_two_readers_do_not_take_each_other_for_a_writer(tmp_path: Path) -> None:
    path = journal(tmp_path, good(1))
    with path.open("rb") as reader:
        fcntl.flock(reader, fcntl.LOCK_SH | fcntl.LOCK_NB)
        assert not journal_reader.is_being_recorded(path)
