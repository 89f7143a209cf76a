"""Malformed files: one line that names file and row; no traceback, no silent repair.

Some were found by a fuzzer: each hung, took the memory or ended in a traceback once. `make soak`
raises the number of those that are drawn by SPRINGPOT_FUZZ.
"""

import json
import os
import struct
import zlib
from pathlib import Path
from typing import Any
from unittest import mock

import h5py
import numpy as np
import pytest
from support.files.malformed import DBC, can_frames, malformed

from springpot import DataError, Recording, SpringpotError
from springpot.modelling import split_unit
from springpot.trainer.recordings import recording_file
from springpot.trainer.recordings.formats.importing import ImportOptions, import_file
from springpot.trainer.recordings.journal_blocks import LAST_METADATA, SAMPLES, encode
from springpot.trainer.recordings.recording_file import read_recording, write_recording

COUNT = int(os.environ.get("SPRINGPOT_FUZZ", "100"))
GROUP = 25
METADATA = {"schema": 1, "name": "a", "dt_s": 0.001, "source": "", "details": {}, "block_s": 0.2}
ROWS = "\n".join(f"{k / 100},{k},{k}" for k in range(9))
HEADER = "time_s,position_mm,force_N"
MACH1 = """<Mach-1 File>
<Ramp>
Stage Axis:\tPosition (z)
<DATA>
Time, s\tPosition (z), mm\tFz, gf
0.0\t1\t1
0.1\t2\t2
0.2\x1d\t3\t3
0.3\t4\t4
<END DATA>
"""


def refusal(file: Path, options: ImportOptions | None = None) -> str:
    """The line with which a file is refused, by every command and by `springpot import`."""
    with pytest.raises(SpringpotError) as refused:
        if file.suffix in (".h5", ".journal"):
            read_recording(file)
        import_file(file, None, "none", None, options)
    line = str(refused.value)
    assert line.isprintable()
    assert str(file) in line
    assert len(line) < 3000
    return line


def journal(folder: Path, metadata: bytes) -> Path:
    file = folder / "a.journal"
    blocks = [encode(7, 0, LAST_METADATA, metadata), encode(7, 1, SAMPLES, bytes(16 * 20))]
    file.write_bytes(b"".join(blocks))
    return file


def without(field: str) -> bytes:
    return json.dumps({name: value for name, value in METADATA.items() if name != field}).encode()


WRONG: list[dict[str, Any]] = [
    {"dt_s": "x"}, {"dt_s": -1}, {"dt_s": None}, {"schema": "one"}, {"details": []}, {"zero": "x"},
    {"block_s": [1]}, {"channels": 5}, {"name": 7}, {"dt_s": float("inf")},
]  # fmt: skip


@pytest.mark.parametrize(
    ("metadata", "says"),
    [
        *((without(field), field) for field in METADATA if field != "block_s"),
        *((json.dumps(METADATA | wrong).encode(), next(iter(wrong))) for wrong in WRONG),
        *(
            (text, "no table in JSON")
            for text in (b"", b"\xcc", b"7", b"[]", b'{"a":', b"[" * 3000)
        ),
    ],
)
def test_metadata_of_a_journal(tmp_path: Path, metadata: bytes, says: str) -> None:
    assert says in refusal(journal(tmp_path, metadata))


def test_a_journal_without_the_time_of_a_block(tmp_path: Path) -> None:
    """It is taken for one step."""
    assert len(read_recording(journal(tmp_path, without("block_s"))).force_n) == 20


def hdf5(folder: Path, samples: int = 20, **attributes: Any) -> Path:
    """A recording that others wrote: it carries no checksum."""
    file = folder / "a.h5"
    usual = {"schema": 1, "name": "a", "dt_s": 0.001, "zero": "none", "source": "", "details": "{}",
             "position_delay_s": 0.0, "force_delay_s": 0.0}  # fmt: skip
    with h5py.File(file, "w") as stored:
        stored.attrs.update(usual | attributes)
        for name, unit in {"position_m": "m", "force_n": "N"}.items():
            stored.create_dataset(name, (samples,), "f8", chunks=(10,)).attrs["unit"] = unit
    return file


def test_a_recording_that_declares_more_than_it_can_hold(tmp_path: Path) -> None:
    assert "MiB of samples" in refusal(hdf5(tmp_path, 10**12))


@pytest.mark.parametrize(
    "wrong", [{"zero": "x"}, {"details": "[]"}, {"dt_s": 0.0}, {"dt_s": np.nan}, {"name": 7.5}]
)
def test_attributes_of_a_recording(tmp_path: Path, wrong: dict[str, Any]) -> None:
    assert "not a springpot recording" in refusal(hdf5(tmp_path, **wrong))


def test_hdf5_without_our_checksum_is_read_in_a_process_of_its_own(tmp_path: Path) -> None:
    """The library hangs on some flipped bytes: only what springpot wrote is shown to it here."""
    samples = np.arange(20.0) * 1e-3
    whole = Recording("a", samples, 2 * samples, 1e-3, details={"k": [1]}, channels={"c": samples})
    file = tmp_path / "a.h5"
    write_recording(file, whole)
    file.write_bytes(file.read_bytes()[:-48])
    with mock.patch.object(recording_file, "read_hdf5", side_effect=AssertionError):
        found = read_recording(file)
    assert found.content_hash == whole.content_hash
    assert (found.name, found.details, found.dt_s) == ("a", {"k": [1]}, 1e-3)
    assert found.channels["c"].tolist() == samples.tolist()


@pytest.mark.parametrize(
    "text",
    [f"{HEADER},{'x' * 200_000}\n{ROWS}", f'{HEADER}\n"{"9" * 300_000}\n{ROWS}', "x" * 900_000,
     HEADER + ",a" * 200_000 + "\n" + ROWS, ",;\t" * 300_000,
     "<Mach-1 File>\n" + "<\x1b[2J>\n" * 5000],
)  # fmt: skip
def test_tables_of_odd_shapes(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    refusal(tmp_path / "a.csv")


@pytest.mark.parametrize("time", ["0.0{}e-" + "9" * 5000, "0e99999{}"])
def test_exponents_that_no_number_has(time: str, tmp_path: Path) -> None:
    rows = "".join(f"\n{time.format(k)},{k},{k}" for k in range(5))
    (tmp_path / "a.csv").write_text(HEADER + rows)
    assert "stands still" in refusal(tmp_path / "a.csv")


def test_the_patterns_of_units_see_no_long_header() -> None:
    header = "_" * 1000 + " (mm)"
    assert split_unit(header, "position") == (header, None)


def test_a_separator_of_text_within_a_number(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(MACH1)
    assert "row 8: '0.2\\x1d' is not a number" in refusal(tmp_path / "a.txt")


def blf(folder: Path, content: bytes) -> str:
    (folder / "rig.dbc").write_text(DBC)
    (folder / "a.blf").write_bytes(content)
    return refusal(folder / "a.blf", ImportOptions(dbc=folder / "rig.dbc"))


def test_an_object_of_no_size_in_a_log(tmp_path: Path) -> None:
    content = bytearray(can_frames("blf", compression_level=0))
    at = content.index(b"LOBJ", content.index(b"LOBJ") + 1)  # the first inside the container
    struct.pack_into("<L", content, at + 8, 0)
    assert "an object of 0 bytes" in blf(tmp_path, bytes(content))


def test_a_log_that_unpacks_to_any_size(tmp_path: Path) -> None:
    packed = zlib.compress(bytes(50 << 20))
    container = struct.pack("<H6xL4x", 2, 50 << 20) + packed
    header = can_frames("blf")[:144]
    content = header + struct.pack("<4sHHLL", b"LOBJ", 16, 1, 16 + len(container), 10) + container
    assert "20 times its size" in blf(tmp_path, content)


def test_arrays_of_zeros_that_no_file_holds(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.mat", "w") as stored:
        for name in ("time_s", "position_mm", "force_N"):
            stored.create_dataset(name, (4_000_000,), "f8", chunks=(1000,))
    assert "MiB of numbers" in refusal(tmp_path / "a.mat")


def test_a_message_is_one_line_whatever_it_quotes() -> None:
    assert str(DataError("a\nb\x1b[2J\tü\udcff")) == "a\\nb\\x1b[2J\\tü\\udcff"
    line = str(DataError("file: " + "x" * 10_000 + ": correct it"))
    assert len(line) <= 2000
    assert line.startswith("file: x")
    assert line.endswith("x: correct it")


@pytest.mark.parametrize("group", range(-(-COUNT // GROUP)))
def test_malformed_rows_are_named(tmp_path: Path, group: int) -> None:
    (tmp_path / "rig.dbc").write_text(DBC)
    for seed in range(group * GROUP, (group + 1) * GROUP):
        case = malformed(np.random.default_rng(seed))
        (tmp_path / case.name).write_bytes(case.content)
        options = ImportOptions(dbc=tmp_path / "rig.dbc" if case.options.get("dbc") else None)
        line = refusal(tmp_path / case.name, options)
        assert len(line) < 1000, case.what
        assert not case.row or f", row {case.row}" in line, f"{case.what}: {line}"
