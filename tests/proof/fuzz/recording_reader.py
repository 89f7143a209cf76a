"""Recordings: HDF5 files as JSON describes them, or raw bytes of one."""

import io
import json
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import h5py
import numpy as np
from proof.fuzz.reader import Reader
from support.small import press, recording

from springpot.trainer.recordings.recording_file import read_recording, write_recording
from springpot.trainer.recordings.recording_hdf5 import read_hdf5

_ATTRIBUTES = {
    "schema": 1, "name": "a", "dt_s": 0.001, "zero": "none", "position_delay_s": 0.0,
    "force_delay_s": 0.0, "source": "sim://x", "details": "{}",
}  # fmt: skip
_SAMPLES = {"shape": [50], "type": "f8", "unit": "m"}


def seeds() -> Iterator[tuple[str, bytes]]:
    """A description of a recording, one with channels, and two files: ours and a plain one."""
    sets = {"position_m": _SAMPLES, "force_n": _SAMPLES | {"unit": "N"}}
    yield "described", json.dumps({"attributes": _ATTRIBUTES, "sets": sets}).encode()
    sets["channels/notes"] = _SAMPLES | {"type": "i4"}
    yield "channels", json.dumps({"attributes": _ATTRIBUTES, "sets": sets}).encode()
    with TemporaryDirectory() as folder:
        file = Path(folder) / "a.h5"
        write_recording(file, recording("a", press(5.0)[:60]))
        yield "file", file.read_bytes()
        file.write_bytes(hdf5_of(json.dumps({"attributes": _ATTRIBUTES, "sets": sets}).encode()))
        yield "plain file", file.read_bytes()


def hdf5_of(content: bytes) -> bytes:
    """The file that a description is of. Raises whatever h5py does where it cannot be made."""
    described = json.loads(content)
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        for name, value in described["attributes"].items():
            file.attrs[name] = value
        for name, samples in described["sets"].items():
            made = _data_set(file, name, samples)
            if "unit" in samples:
                made.attrs["unit"] = samples["unit"]
    return memory.getvalue()


def _data_set(file: h5py.File, name: str, samples: dict[str, Any]) -> h5py.Dataset:
    """A data set of zeros, none of which are stored: it may be of any size."""
    shape = tuple(int(length) for length in samples["shape"])
    chunks = tuple(min(max(length, 1), 64) for length in shape) or None
    return file.create_dataset(name, shape, np.dtype(samples["type"]), chunks=chunks)


def read(content: bytes, folder: Path) -> None:
    """Read it in this process, so that the fuzzer sees the branches taken."""
    if file := _file(content, folder):
        read_hdf5(file)


def as_users(content: bytes, folder: Path) -> None:
    """Read it as every command does: what carries no checksum of ours, in a process of its own."""
    if file := _file(content, folder):
        read_recording(file)


def _file(content: bytes, folder: Path) -> Path | None:
    if content.startswith(b"{"):
        try:
            content = hdf5_of(content)
        except Exception:  # describes no file
            return None
    file = folder / "a.h5"
    file.write_bytes(content)
    return file


READER = Reader(
    seeds,
    read,
    words=(
        '"attributes"', '"sets"', '"shape": [', '"type": "', "position_m", "force_n", "channels/",
        '"S8"', '"f4"', '"i8"', '"c16"', '"M8[s]"', '"V8"', "null", "[]", "1e999", "NaN", "-1",
        "1000000000", '"zero"', '"min"', '"details"', '"{"', '"[[["',
        "\\x89HDF\\x0d\\x0a\\x1a\\x0a",
        "TREE", "SNOD", "HEAP", "OHDR", "OCHK",
    ),
    as_users=as_users,
)  # fmt: skip
