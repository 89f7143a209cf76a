"""Recordings as HDF5 files: what is written is read, and damage is never read as data."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import (
    read_recording,
    read_recordings,
    write_recording,
)
from springpot.trainer.recordings.recording_name import safe_recording_name

FIXED = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def example(name: str = "press") -> Recording:
    position_m = np.linspace(0.0, 0.01, 50)
    return Recording(
        name, position_m, 300.0 * position_m, 1e-3, "first", 1e-4, 2e-4, "a.csv", {"cycles": 20}
    )


def refusal(path: Path) -> str:
    with pytest.raises(DataError) as error:
        read_recording(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)
    return str(error.value)


@FIXED
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
        safe_recording_name(text), samples, -samples, dt_s, "min", 0.1, 0.2, text, details
    )
    write_recording(tmp_path / "a.h5", written)
    read = read_recording(tmp_path / "a.h5")
    assert read.content_hash == written.content_hash
    for name in ("name", "dt_s", "zero", "position_delay_s", "force_delay_s", "source", "details"):
        assert getattr(read, name) == getattr(written, name)
    assert [file.name for file in tmp_path.iterdir()] == ["a.h5"]


def test_other_software_reads_and_may_edit_it(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    with h5py.File(file, "r+") as opened:
        assert opened["position_m"].shape == (50,)
        assert opened["force_n"].attrs["unit"] == "N"
        opened.attrs["comment"] = "second press"
    assert read_recording(file).content_hash == example().content_hash


@FIXED
@given(st.data())
def test_a_flipped_byte_is_refused(tmp_path: Path, data: st.DataObject) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    content = bytearray(file.read_bytes())
    checksum = len(content) - 48  # a flip in the checksum's own mark leaves a whole HDF5 file
    content[data.draw(st.integers(0, checksum - 1))] ^= data.draw(st.integers(1, 255))
    file.write_bytes(content)
    assert "damaged" in refusal(file)


@settings(FIXED, max_examples=20)  # each is read in a process of its own
@given(st.data())
def test_a_truncated_file_is_refused(tmp_path: Path, data: st.DataObject) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    content = file.read_bytes()
    hdf5_bytes = len(content) - 48
    file.write_bytes(content[: data.draw(st.integers(0, hdf5_bytes - 1))])
    assert "not a springpot recording" in refusal(file)


def test_damaged_samples_without_a_seal_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    with h5py.File(file, "r+") as opened:
        chunk = opened["force_n"].id.get_chunk_info(0)
        opened.attrs["comment"] = "cuts the checksum off"
    content = bytearray(file.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 0x10
    file.write_bytes(content)
    assert "not a springpot recording" in refusal(file)


def test_a_later_schema_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    with h5py.File(file, "r+") as opened:
        opened.attrs["schema"] = 2
    assert "recording schema 2" in refusal(file)
    assert "upgrade springpot" in refusal(file)


def test_another_unit_or_a_missing_channel_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    write_recording(file, example())
    with h5py.File(file, "r+") as opened:
        opened["position_m"].attrs["unit"] = "mm"
    assert "position_m is in 'mm', not 'm'" in refusal(file)
    with h5py.File(file, "r+") as opened:
        del opened["position_m"]
    assert "not a springpot recording" in refusal(file)


@pytest.mark.parametrize(
    "content", [b"", b"time_s,position_m,force_N\n0,0,0\n", b"\x89HDF\r\n\x1a\n"]
)
def test_no_hdf5_is_refused(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "a.h5"
    file.write_bytes(content)
    assert "make one with `springpot import`" in refusal(file)


def test_folders_are_read_in_the_order_of_names(tmp_path: Path) -> None:
    for name in ("b", "a", "c"):
        write_recording(tmp_path / f"{name}.h5", example(name))
    names = [recording.name for recording in read_recordings([tmp_path, tmp_path / "b.h5"])]
    assert names == ["a", "b", "c", "b"]
    assert "no such file" in refusal(tmp_path / "d.h5")
    (tmp_path / "empty").mkdir()
    with pytest.raises(DataError, match=r"no \.h5 file in this folder"):
        read_recordings([tmp_path / "empty"])
