"""Recordings as HDF5 files: what is written is read, damage is never read as data."""

import dataclasses
import hashlib
import json
import os
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from springpot.codegen.errors import DataError
from springpot.trainer.recordings import recording_file
from springpot.trainer.recordings.recording import SIGN_RULE, Recording
from springpot.trainer.recordings.recording_file import (
    has_checksum,
    read_recording,
    read_recordings,
    recording_files,
    write_recording,
)
from springpot.trainer.recordings.recording_name import safe_recording_name

MARK = b"springpot sha256"
PRESS = Recording(
    name="press",
    position_m=np.array([0.0, 1e-3, 3e-3]),
    force_n=np.array([0.0, 0.5, 1.5]),
    dt_s=0.25,
    zero="min",
    position_delay_s=0.125,
    force_delay_s=0.375,
    source="a.csv",
    details={"cycles": 20, "by": {"hand": True}},
    channels={"input_m": np.array([1.0, 2.0, 3.0]), "notes": np.array([4.0, 5.0, 6.0])},
)


def stored(folder: Path, recording: Recording = PRESS) -> Path:
    path = folder / "press.h5"
    write_recording(path, recording)
    return path


def refused(path: Path, told: str) -> None:
    with pytest.raises(DataError, match=told) as error:
        read_recording(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_every_field_comes_back(tmp_path: Path) -> None:
    found = read_recording(stored(tmp_path))
    for field in dataclasses.fields(Recording):
        expected, value = getattr(PRESS, field.name), getattr(found, field.name)
        if field.name == "channels":
            assert list(value) == list(expected)
            assert all(np.array_equal(value[name], expected[name]) for name in expected)
        elif isinstance(expected, np.ndarray):
            assert value.dtype == np.float64
            assert np.array_equal(value, expected)
        else:
            assert value == expected, field.name


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=40),
    st.floats(1e-6, 10.0),
    st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=20),
    st.dictionaries(st.sampled_from("abc"), st.one_of(st.integers(), st.text(max_size=5))),
)
def test_round_trip(
    tmp_path: Path, values: list[float], dt_s: float, text: str, details: dict[str, int | str]
) -> None:
    samples = np.array(values)
    written = Recording(
        safe_recording_name(text), samples, -samples, dt_s, "min", 0.1, 0.2, f"of {text}", details
    )
    write_recording(tmp_path / "a.h5", written)
    read = read_recording(tmp_path / "a.h5")
    assert read.content_hash == written.content_hash
    for name in ("name", "dt_s", "zero", "position_delay_s", "force_delay_s", "source", "details"):
        assert getattr(read, name) == getattr(written, name)
    assert [file.name for file in tmp_path.iterdir()] == ["a.h5"]


def test_what_is_not_said_is_nothing() -> None:
    plain = Recording("press", PRESS.position_m, PRESS.force_n, 0.25)
    assert (plain.zero, plain.position_delay_s, plain.force_delay_s) == ("none", 0.0, 0.0)
    assert (plain.source, dict(plain.details), dict(plain.channels)) == ("", {}, {})
    assert (plain.rate_hz, plain.duration_s) == (4.0, 0.75)
    assert Recording("two", [0.0, 0.0], [1.0, 1.0], 1e-9).duration_s == 2e-9
    with pytest.raises(dataclasses.FrozenInstanceError):
        plain.dt_s = 1.0  # type: ignore[misc]
    assert plain != Recording("press", PRESS.position_m, PRESS.force_n, 0.25)  # by identity


def test_the_content_hash_is_that_of_what_a_fit_sees() -> None:
    values = np.concatenate([[0.25], PRESS.position_m, PRESS.force_n]).astype("<f8")
    assert PRESS.content_hash == hashlib.sha256(values.tobytes()).hexdigest()


def test_the_file_says_units_signs_and_schema(tmp_path: Path) -> None:
    with h5py.File(stored(tmp_path), "r") as file:
        assert dict(file.attrs) == {
            "schema": 1,
            "name": "press",
            "dt_s": 0.25,
            "sign_rule": SIGN_RULE,
            "zero": "min",
            "position_delay_s": 0.125,
            "force_delay_s": 0.375,
            "source": "a.csv",
            "details": json.dumps({"by": {"hand": True}, "cycles": 20}),
        }
        assert list(file.attrs)[:2] == ["schema", "name"]  # in the order written
        assert list(file) == ["position_m", "force_n", "channels"]
        assert list(file["channels"]) == ["input_m", "notes"]
        assert file["position_m"].attrs["unit"] == "m"
        assert file["force_n"].attrs["unit"] == "N"
        for data in (file["position_m"], file["channels/notes"]):
            assert (data.compression, data.compression_opts) == ("gzip", 1)
            assert data.shuffle and data.fletcher32 and data.chunks == (3,)


def test_long_channels_are_stored_in_blocks_and_checked_whole(tmp_path: Path) -> None:
    long = np.zeros((1 << 17) + 5)
    noise = np.frombuffer(np.random.default_rng(1).bytes(8 * len(long)), np.uint64) / 2.0**64
    path = stored(tmp_path, Recording("long", noise, long, 1e-3))
    with h5py.File(path, "r") as file:
        assert file["position_m"].chunks == (1 << 17,)
    content = bytearray(path.read_bytes())
    assert len(content) > 1 << 19
    assert np.array_equal(read_recording(path).position_m, noise)
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    refused(path, "damaged")


def test_a_source_that_is_no_text_is_kept_for_people(tmp_path: Path) -> None:
    recording = dataclasses.replace(PRESS, source="caf\udce9.csv")
    assert read_recording(stored(tmp_path, recording)).source == r"caf\udce9.csv"


def test_behind_the_file_stands_its_checksum(tmp_path: Path) -> None:
    path = stored(tmp_path)
    content = path.read_bytes()
    body, mark, digest = content[:-48], content[-48:-32], content[-32:]
    assert mark == MARK and digest == hashlib.sha256(body).digest()
    assert has_checksum(path)
    for place in (len(content) - 1, len(content) - 32, 0, len(body) - 1):
        damaged = bytearray(content)
        damaged[place] ^= 1
        path.write_bytes(damaged)
        refused(path, "damaged, its bytes differ from those written")
    path.write_bytes(body)  # as a program that edits it leaves it
    assert not has_checksum(path)
    assert read_recording(path).name == "press"
    for short in (b"", b"x", MARK, content[-48:], b"time_s\n0\n", body[:8], body[: len(body) // 2],
                  body[:-1]):  # fmt: skip
        path.write_bytes(short)
        assert has_checksum(path) == (short[:16] == MARK and len(short) <= 48)
        refused(path, "not a springpot recording .*: make one with `springpot import`")


def test_damaged_samples_without_a_checksum_are_refused(tmp_path: Path) -> None:
    path = stored(tmp_path)
    with h5py.File(path, "r+") as file:  # as other software: cuts the checksum off
        chunk = file["force_n"].id.get_chunk_info(0)
        file.attrs["comment"] = "changed"
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 0x10
    path.write_bytes(content)
    refused(path, "not a springpot recording")


def test_the_checksum_covers_every_byte_of_a_file_of_any_length(tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    for length in (1, (1 << 20) + 1):  # a block of reading and one byte
        body = bytes(length)
        path.write_bytes(body + MARK + hashlib.sha256(body).digest())
        refused(path, r"not a springpot recording \(.{10,}\)")  # undamaged, and none
        path.write_bytes(body[:-1] + b"x" + MARK + hashlib.sha256(body).digest())
        refused(path, "damaged")


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.h5")
    refused(tmp_path / "pipe.h5", "a pipe or device, not a file")


def test_an_existing_file_is_kept_where_that_is_asked(tmp_path: Path) -> None:
    path = stored(tmp_path)
    other = dataclasses.replace(PRESS, source="b.csv")
    with pytest.raises(FileExistsError):
        write_recording(path, other, overwrite=False)
    assert read_recording(path).source == "a.csv"
    write_recording(path, other)
    assert read_recording(path).source == "b.csv"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"position_m": np.zeros(4)}, r"press: position has \(4,\) samples and force \(3,\)"),
        ({"position_m": np.zeros((3, 1)), "force_n": np.zeros((3, 1))}, "give two 1-D channels"),
        ({"position_m": [0.0], "force_n": [0.0], "channels": {}}, "press: 1 rows: .* needs two"),
        ({"channels": {"notes": np.zeros(2)}}, r"press: notes has \(2,\) samples"),
        *(({"dt_s": dt_s}, f"press: dt_s={dt_s} is not a time step")
          for dt_s in (0.0, -1e-3, float("inf"), float("nan"))),
        *(({"dt_s": dt_s}, "dt_s") for dt_s in ("0.001", None, True)),
        ({"position_m": [0.0, 1.0, np.nan]}, r"press: position is not finite at row 2 \(1 rows"),
        ({"force_n": [0.0, np.inf, -np.inf]}, r"press: force is not finite at row 1 \(2 rows"),
        *(({"force_n": wrong}, "force_n: ") for wrong in ([True] * 3, [0j] * 3, ["0"] * 3)),
        ({"position_m": np.ma.masked_less([0.0, 1.0, 2.0], 1.0)}, "position_m: "),
        ({"position_m": [[0.0], [0.0, 1.0]]}, "position_m: "),
        ({"name": "a/b"}, "a recording named"),
        *(({"name": name}, "name") for name in (5, None)),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_refused(changes: dict[str, object], told: str) -> None:
    with pytest.raises(DataError, match=told) as refused:
        dataclasses.replace(PRESS, **changes)  # type: ignore[arg-type]
    assert str(refused.value).isprintable()


def test_another_unit_or_a_newer_schema_is_refused(tmp_path: Path) -> None:
    for channel, unit in (("position_m", "mm"), ("force_n", "kgf")):
        path = stored(tmp_path)
        with h5py.File(path, "r+") as file:
            file[channel].attrs["unit"] = unit
        refused(path, f"{channel} is in '{unit}', not '.*': import again")
    path = stored(tmp_path)
    with h5py.File(path, "r+") as file:
        file.attrs["schema"] = 2
    refused(path, "recording schema 2, this springpot reads up to 1: upgrade")
    with h5py.File(path, "r+") as file:
        file.attrs["schema"] = 0
    assert read_recording(path).name == "press"


@pytest.mark.parametrize("gone", ["schema", "name", "dt_s", "zero", "position_delay_s",
                                  "force_delay_s", "source", "details"])  # fmt: skip
def test_a_file_without_a_field_is_refused(tmp_path: Path, gone: str) -> None:
    path = stored(tmp_path)
    with h5py.File(path, "r+") as file:
        del file.attrs[gone]
    refused(path, "not a springpot recording .*: make one")


def test_channels_of_another_number_type_are_read_as_doubles(tmp_path: Path) -> None:
    path = stored(tmp_path)
    with h5py.File(path, "r+") as file:
        for name in ("position_m", "force_n", "channels/notes"):
            values, unit = file[name][:], file[name].attrs.get("unit")
            del file[name]
            file.create_dataset(name, data=values.astype(np.float32))
            if unit is not None:
                file[name].attrs["unit"] = unit
    found = read_recording(path)
    for samples in (found.position_m, found.force_n, found.channels["notes"]):
        assert samples.dtype == np.float64


def test_a_file_without_further_channels_has_none(tmp_path: Path) -> None:
    path = stored(tmp_path)
    with h5py.File(path, "r+") as file:
        del file["channels"]
    assert dict(read_recording(path).channels) == {}


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    for name in ("none.h5", "none.journal", "none.txt"):
        refused(tmp_path / name, "no such file")
    with pytest.raises(DataError, match=r"no \.h5 file in this folder"):
        recording_files([tmp_path])
    (tmp_path / "a.h5").mkdir()
    refused(tmp_path / "a.h5", "cannot be read .Is a directory")


def test_what_is_still_being_recorded_is_not_read(tmp_path: Path, monkeypatch) -> None:
    journal = tmp_path / "a.journal"
    journal.touch()
    monkeypatch.setattr(recording_file, "is_being_recorded", lambda path: path == journal)
    refused(journal, "still being recorded: wait until that ends")
    with pytest.raises(DataError, match="still being recorded"):
        read_recording(tmp_path / "a.h5")


def test_files_and_folders_are_taken_in_order(tmp_path: Path) -> None:
    for name in ("b", "a"):
        write_recording(tmp_path / f"{name}.h5", dataclasses.replace(PRESS, name=name))
    other = tmp_path / "c.txt"
    other.touch()
    assert recording_files([other, tmp_path]) == [other, tmp_path / "a.h5", tmp_path / "b.h5"]
    found = read_recordings([tmp_path, tmp_path / "b.h5"])
    assert [recording.name for recording in found] == ["a", "b", "b"]
