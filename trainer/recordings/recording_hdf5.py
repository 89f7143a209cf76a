"""Layout of a recording in HDF5: a 1-D data set a channel, attributes as metadata.

The SHA-256 of the file stands in its user block, which HDF5 readers skip, and is compared before
the library reads: on a flipped byte that can hang, whatever checksums its own format has (tried
with those of HDF5 1.10: 1 of some 3 000 flips did not end).
"""

import hashlib
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.atomic_write import written_aside
from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import max_unpacked_bytes
from springpot.trainer.recordings.metadata import (
    RECORDING_SCHEMA,
    checked_metadata,
    metadata_of_json,
)
from springpot.trainer.recordings.recording import SIGN_RULE, Recording

MAX_RATIO = 256  # a recording of nothing but zeros shrinks by 230
_CHANNEL_UNITS = {"position_m": "m", "force_n": "N"}
_WRITTEN = ("zero", "position_delay_s", "force_delay_s")  # by every springpot
_MORE = "channels"  # group of the channels beside these two
_CHUNK_SAMPLES = 1 << 17
_USER_BLOCK = 512  # bytes
_MAGIC = b"springpot recording, SHA-256 of what follows: "
# The library raises whatever it meets in a file that others damaged.
_RAISED = (OSError, KeyError, TypeError, ValueError, RuntimeError, AttributeError, MemoryError)


def write_recording(path: Path, recording: Recording, *, overwrite: bool = True) -> None:
    """Write a recording aside, sync and rename it to `path`: a reader never sees half a file.

    overwrite: False raises FileExistsError if `path` exists, even if it came meanwhile.
    Raises OSError, and leaves nothing aside, if that fails.
    """
    with written_aside(path, overwrite=overwrite, durable=True) as aside:
        _write(aside, recording)
        digest = _digest(aside)
        with aside.open("r+b") as file:
            file.write(_MAGIC + digest.encode() + b"\n")


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        file.seek(_USER_BLOCK)
        return hashlib.file_digest(file, "sha256").hexdigest()


def _write(path: Path, recording: Recording) -> None:
    with h5py.File(path, "w", track_order=True, userblock_size=_USER_BLOCK) as file:
        file.attrs["schema"] = RECORDING_SCHEMA
        file.attrs["name"] = recording.name
        file.attrs["dt_s"] = recording.dt_s
        file.attrs["sign_rule"] = SIGN_RULE
        file.attrs["zero"] = recording.zero
        file.attrs["position_delay_s"] = recording.position_delay_s
        file.attrs["force_delay_s"] = recording.force_delay_s
        if recording.session and recording.start_s is not None:
            file.attrs["session"] = recording.session
            file.attrs["start_s"] = recording.start_s
        if recording.place_m is not None:
            file.attrs["place_x_m"], file.attrs["place_y_m"] = recording.place_m
        # HDF5 holds UTF-8: of a path that is none, the bytes as \xff, for people.
        file.attrs["source"] = recording.source.encode("utf-8", "backslashreplace").decode()
        file.attrs["details"] = json.dumps(dict(recording.details), sort_keys=True)
        for channel, unit in _CHANNEL_UNITS.items():
            _data_set(file, channel, getattr(recording, channel)).attrs["unit"] = unit
        for channel, samples in recording.channels.items():
            _data_set(file, f"{_MORE}/{channel}", samples)


def _data_set(file: h5py.File, name: str, samples: Samples) -> h5py.Dataset:
    return file.create_dataset(
        name,
        data=samples,
        chunks=(min(len(samples), _CHUNK_SAMPLES),),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
        fletcher32=True,
    )


def is_recording(path: Path) -> bool:
    """Whether a file begins as a recording of springpot's."""
    with path.open("rb") as file:
        return file.read(len(_MAGIC)) == _MAGIC


def read_hdf5(path: Path) -> Recording:
    """Read a recording. Raises DataError for a file that is damaged, or none."""
    with path.open("rb") as file:
        head = file.read(_USER_BLOCK)
    if not head.startswith(_MAGIC):
        raise DataError(f"{path}: not a springpot recording: make one with `springpot import`")
    if head[len(_MAGIC) :].rstrip(b"\0\n") != _digest(path).encode():
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")
    try:
        with h5py.File(path, "r") as file:
            return _recording(path, file)
    except DataError:
        raise
    except _RAISED as error:
        reason = " ".join(str(error).split())
        raise DataError(
            f"{path}: not a springpot recording ({reason}): make one with `springpot import`"
        ) from None


def _recording(path: Path, file: h5py.File) -> Recording:
    attributes = {name: _plain(value) for name, value in file.attrs.items()}
    attributes["details"] = metadata_of_json(str(path), attributes.get("details", ""))
    metadata = checked_metadata(str(path), attributes, required=_WRITTEN)
    sets = {channel: file[channel] for channel in _CHANNEL_UNITS}
    for channel, unit in _CHANNEL_UNITS.items():
        found = sets[channel].attrs["unit"]
        if found != unit:
            raise DataError(f"{path}: {channel} is in {found!r}, not {unit!r}: import again")
    sets |= {f"{_MORE}/{channel}": file[_MORE][channel] for channel in file.get(_MORE, ())}
    _require_samples(path, sets)
    samples = {name: np.asarray(stored, dtype=np.float64) for name, stored in sets.items()}
    position_m, force_n = samples.pop("position_m"), samples.pop("force_n")
    channels = {name.removeprefix(f"{_MORE}/"): found for name, found in samples.items()}
    return metadata.recording(str(path), position_m, force_n, channels)


def _plain(value: Any) -> Any:
    """An attribute's value as Python's own type."""
    return value.item() if isinstance(value, np.generic) else value


def _require_samples(path: Path, sets: Mapping[str, Any]) -> None:
    """Numbers, and not more than the file can hold: HDF5 stores what is nowhere written as zeros.

    Before any is read, since reading takes the memory.
    """
    for name, stored in sets.items():
        if not isinstance(stored, h5py.Dataset) or stored.dtype.kind not in "fiu":
            raise DataError(f"{path}: {name} is no data set of numbers: import again")
        if math.prod(stored.shape or ()) and not stored.id.get_storage_size():
            raise DataError(f"{path}: {name} has no samples stored: import again")
    declared = sum(8 * math.prod(stored.shape or ()) for stored in sets.values())
    if declared > max_unpacked_bytes(path.stat().st_size, MAX_RATIO):
        raise DataError(
            f"{path}: declares {declared >> 20} MiB of samples in {path.stat().st_size} bytes: "
            "import again"
        )
