"""Crash safety: each fault by a real process; what is left reads, or is refused in one line."""

import dataclasses
import json
import random
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from support.peer import CLI

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings import journal_blocks
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.journal import JournalWriter
from springpot.trainer.recordings.journal_blocks import (
    BLOCK_BYTES,
    LAST_METADATA,
    METADATA,
    PAIRS,
    SAMPLES,
)
from springpot.trainer.recordings.recording_file import read_recording, read_recordings

N = 3000
POSITION_M = np.arange(N) * 1e-6
# Records N samples, 100 at a time, and dies as its arguments say.
CHILD = """
import os, pathlib, resource, signal, sys
import numpy as np
from springpot.codegen.errors import SpringpotError
from springpot.host.cli import exit_status
from springpot.trainer.recordings.journal import JournalWriter
file, fault, where, share = pathlib.Path(sys.argv[1]), *sys.argv[2:]
def die(*_, **__): os.kill(os.getpid(), signal.SIGKILL)
if fault == "block":
    write, seen = os.write, []
    def dying(descriptor, content):
        seen.append(content)
        if len(seen) == int(where):
            write(descriptor, content[: int(float(share) * len(content))])
            die()
        return write(descriptor, content)
    os.write = dying
elif fault == "before":
    setattr(pathlib.Path, where, die)
elif fault == "after":
    did = getattr(pathlib.Path, where)
    setattr(pathlib.Path, where, lambda *a, **k: (did(*a, **k), die()))
elif fault == "full":
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(where), int(where)))
try:
    with JournalWriter(file, "a", 1e-3, "test", {"k": 1}) as journal:
        for k in range(0, 3000, 100):
            x = np.arange(k, k + 100) * 1e-6
            journal.append(x, 2 * x)
        if fault == "full at the end":
            resource.setrlimit(resource.RLIMIT_FSIZE, (int(where), int(where)))
        journal.finish()
except SpringpotError as error:
    print(error)
    sys.exit(exit_status(error))
"""


def child(file: Path, fault: str, where: str, share: str = "0") -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", CHILD, str(file), fault, where, share]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def assert_prefix(file: Path, at_least: int) -> None:
    recording = read_recording(file)
    count = len(recording.position_m)
    assert at_least <= count <= N
    np.testing.assert_array_equal(recording.position_m, POSITION_M[:count])
    np.testing.assert_array_equal(recording.force_n, 2 * POSITION_M[:count])
    assert recording.details["k"] == 1


def write_journal(file: Path, samples: int = N) -> Path:
    """Leave a journal behind, as an error in the middle of a recording does."""
    with pytest.raises(KeyError), JournalWriter(file, "a", 1e-3, "test", {"k": 1}) as writer:
        writer.append(POSITION_M[:samples], 2 * POSITION_M[:samples])
        raise KeyError
    return writer.journal


@pytest.mark.parametrize("share", ["0", "0.5", "1"])
@pytest.mark.parametrize("block", [2, 5, 9])
def test_killed_in_a_block(
    tmp_path: Path, block: int, share: str, caplog: pytest.LogCaptureFixture
) -> None:
    assert child(tmp_path / "a.h5", "block", str(block), share).returncode == -signal.SIGKILL
    assert [file.name for file in tmp_path.iterdir()] == ["a.journal"]
    whole = (block - 2 + int(share == "1")) * PAIRS  # the first block holds the metadata
    if not whole:
        with pytest.raises(DataError, match=r"a\.journal: .*interrupted before its first samples"):
            read_recordings([tmp_path])
        return
    assert_prefix(tmp_path / "a.h5", whole)  # by its name, too
    (recording,) = read_recordings([tmp_path])
    assert len(recording.position_m) == whole
    assert "recovered" in recording.details
    assert "a.journal: recovered" in caplog.text


@pytest.mark.parametrize(
    ("when", "call"),
    [
        ("before", "hardlink_to"),
        ("after", "hardlink_to"),
        ("before", "unlink"),
        ("after", "unlink"),
    ],
)
def test_killed_around_the_rename(
    tmp_path: Path, when: str, call: str, caplog: pytest.LogCaptureFixture
) -> None:
    assert child(tmp_path / "a.h5", when, call).returncode == -signal.SIGKILL
    (recording,) = read_recordings([tmp_path])
    assert len(recording.position_m) == N
    assert_prefix(tmp_path / "a.h5", N)
    assert "a.journal" in caplog.text


def test_killed_while_recording(tmp_path: Path) -> None:
    """The command itself, killed at a random moment: every press before it is there."""
    out = tmp_path / "out"
    arguments = ["record", "--device", "sim://ecoflex-00-30", "--protocol", "paper", "--out", out]
    process = subprocess.Popen([*CLI, *map(str, arguments)], stderr=subprocess.DEVNULL)
    while process.poll() is None and len(list(out.glob("*.h5"))) < 2:
        time.sleep(0.002)
    time.sleep(random.uniform(0.0, 0.1))
    process.kill()
    process.wait()
    for file in out.iterdir():
        if file.suffix == ".part":
            continue
        try:
            assert len(read_recording(file).position_m) > 0
        except DataError as error:
            assert "interrupted" in str(error)
    assert len(read_recordings(out.glob("*.h5"))) >= 2


def test_interrupted_by_the_keyboard(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    journal = write_journal(tmp_path / "a.h5", 1100)
    assert "a.journal: what was recorded until now is kept there" in caplog.text
    assert_prefix(journal, 1100)
    (part,) = import_file(journal, None, "none", None).recordings
    assert "recovered" in part.details
    with pytest.raises(UsageError, match=r"a\.journal: keeps a recording that was interrupted"):
        JournalWriter(tmp_path / "a.h5", "a", 1e-3, "test", {})


def test_where_nothing_was_recorded_nothing_is_left(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write_journal(tmp_path / "a.h5", 1)
    assert not [*tmp_path.iterdir()]
    assert not caplog.text


@pytest.mark.parametrize("room", [BLOCK_BYTES * 3, BLOCK_BYTES * 5 + 1000])
def test_a_full_disk_while_recording(tmp_path: Path, room: int) -> None:
    result = child(tmp_path / "a.h5", "full", str(room))
    assert result.returncode == 5
    assert "a.h5: cannot go on writing (File too large), recording stopped" in result.stdout
    assert_prefix(tmp_path / "a.h5", (room // BLOCK_BYTES - 1) * PAIRS)


def test_a_full_disk_at_the_end(tmp_path: Path) -> None:
    result = child(tmp_path / "a.h5", "full at the end", "5000")
    assert result.returncode == 5
    assert [file.name for file in tmp_path.iterdir()] == ["a.journal"]
    assert_prefix(tmp_path / "a.h5", N - PAIRS)


def test_two_writers(tmp_path: Path) -> None:
    with JournalWriter(tmp_path / "a.h5", "a", 1e-3, "test", {"k": 1}) as first:
        first.append(POSITION_M, 2 * POSITION_M)
        second = child(tmp_path / "a.h5", "none", "0")
        assert second.returncode == 2
        assert "another springpot is recording it now" in second.stdout
        with pytest.raises(DataError, match="still being recorded"):
            read_recording(tmp_path / "a.journal")
        first.finish()
    assert [file.name for file in tmp_path.iterdir()] == ["a.h5"]
    assert_prefix(tmp_path / "a.h5", N)


def test_another_file_of_that_name_is_not_overwritten(tmp_path: Path) -> None:
    with (
        pytest.raises(UsageError, match="kept in"),
        JournalWriter(tmp_path / "a.h5", "a", 1e-3, "test", {"k": 1}) as writer,
    ):
        writer.append(POSITION_M, 2 * POSITION_M)
        (tmp_path / "a.h5").write_text("mine")
        writer.finish()
    assert (tmp_path / "a.h5").read_text() == "mine"
    assert_prefix(tmp_path / "a.journal", N)


def test_slow_recordings_lose_no_more_than_fast_ones(tmp_path: Path) -> None:
    process = [sys.executable, "-c", "import os, signal, sys, pathlib, numpy as np\n"
               "from springpot.trainer.recordings.journal import JournalWriter\n"
               "j = JournalWriter(pathlib.Path(sys.argv[1]), 'a', 0.1, 'test', {})\n"
               "for k in range(23): j.append(np.full(1, k), np.full(1, k))\n"
               "os.kill(os.getpid(), signal.SIGKILL)"]  # fmt: skip
    subprocess.run([*process, str(tmp_path / "a.h5")], check=False)
    assert len(read_recording(tmp_path / "a.h5").position_m) == 20


def test_long_facts_take_several_blocks(tmp_path: Path) -> None:
    details = {"note": "x" * 9000}
    with JournalWriter(tmp_path / "a.h5", "a", 1e-3, "test", details) as writer:
        writer.append(POSITION_M, POSITION_M)
        writer.finish()
    assert read_recording(tmp_path / "a.h5").details == json.loads(json.dumps(details))


def test_blocks_are_as_long_as_in_the_journals_that_are_there() -> None:
    assert BLOCK_BYTES == 4096
    assert (METADATA, LAST_METADATA, SAMPLES) == (0, 1, 2)


def test_a_damaged_block_or_one_of_a_wrong_head_is_none() -> None:
    good = journal_blocks.encode(1, 2, SAMPLES, bytes(32))
    for at in range(len(good)):
        assert journal_blocks.decode(good[:at] + bytes([good[at] ^ 0x40]) + good[at + 1 :]) is None
    block = journal_blocks.decode(good)
    assert block.rows(2).shape == (2, 2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        block.kind = 0
    too_long = (journal_blocks.PAYLOAD_BYTES // 8 + 1) * 8  # whole numbers, but too many
    for at, value in ((0, b"x"), (good.index(b"\x20"), too_long.to_bytes(2, "little"))):
        body = good[:at] + value + good[at + len(value) : -4]
        assert journal_blocks.decode(body + journal_blocks._CHECKSUM.pack(zlib.crc32(body))) is None
