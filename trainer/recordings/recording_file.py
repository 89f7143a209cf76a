"""Recordings as HDF5 files: one file each, a 1-D data set a channel, attributes as metadata."""

import hashlib
import io
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.atomic_write import written_aside
from springpot.codegen.errors import DataError
from springpot.codegen.regular_file import max_unpacked_bytes, require_regular
from springpot.trainer.recordings.journal_reader import (
    JOURNAL_SUFFIX,
    is_being_recorded,
    journal_of,
    read_journal,
)
from springpot.trainer.recordings.metadata import (
    RECORDING_SCHEMA,
    checked_metadata,
    metadata_of_json,
)
from springpot.trainer.recordings.notices import notice
from springpot.trainer.recordings.reader_limits import MAX_RATIO
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, SIGN_RULE, Recording
from springpot.trainer.recordings.recording_process import read_unsealed

# Behind the HDF5 file stand these bytes and its SHA-256: the library itself can crash or hang on a
# flipped byte. HDF5 readers ignore them; a program that edits the file cuts them off.
_CHECKSUM = b"springpot sha256"
_CHECKSUM_BYTES = len(_CHECKSUM) + hashlib.sha256().digest_size
_CHANNEL_UNITS = {"position_m": "m", "force_n": "N"}
_WRITTEN = ("zero", "position_delay_s", "force_delay_s")  # by every springpot
_MORE = "channels"  # group of the channels beside these two
_CHUNK_SAMPLES = 1 << 17


def write_recording(path: Path, recording: Recording) -> None:
    """Write `recording` aside and rename it to `path`, so that a reader never sees half a file."""
    store_recording(path, recording, overwrite=True)


def store_recording(path: Path, recording: Recording, *, overwrite: bool) -> None:
    """Write aside, sync, rename. Raises OSError, and leaves nothing aside, where that fails.

    overwrite: False raises FileExistsError where `path` exists, even if it came meanwhile.
    """
    content = _hdf5(recording)
    checksum = _CHECKSUM + hashlib.sha256(content).digest()
    with written_aside(path, overwrite=overwrite, durable=True) as aside, aside.open("wb") as file:
        file.write(content)
        file.write(checksum)


def _hdf5(recording: Recording) -> bytes:
    """The file, laid out in memory: on a full disk HDF5 leaves half a file and dies on closing."""
    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True) as file:
        file.attrs["schema"] = RECORDING_SCHEMA
        file.attrs["name"] = recording.name
        file.attrs["dt_s"] = recording.dt_s
        file.attrs["sign_rule"] = SIGN_RULE
        file.attrs["zero"] = recording.zero
        file.attrs["position_delay_s"] = recording.position_delay_s
        file.attrs["force_delay_s"] = recording.force_delay_s
        # HDF5 holds UTF-8: of a path that is none, the bytes as \xff, for people.
        file.attrs["source"] = recording.source.encode("utf-8", "backslashreplace").decode()
        file.attrs["details"] = json.dumps(dict(recording.details), sort_keys=True)
        for channel, unit in _CHANNEL_UNITS.items():
            _data_set(file, channel, getattr(recording, channel)).attrs["unit"] = unit
        for channel, samples in recording.channels.items():
            _data_set(file, f"{_MORE}/{channel}", samples)
    return memory.getvalue()


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


def read_recording(path: Path) -> Recording:
    """Read one recording, or recover what a crash left of it and say so.

    path: an HDF5 file, or a journal. Raises DataError with the file's name where it cannot be used.
    """
    if path.suffix == JOURNAL_SUFFIX:
        return _recovered(path)
    if not path.exists() and path.suffix == RECORDING_SUFFIX and journal_of(path).exists():
        return _recovered(journal_of(path))
    # Only a file as springpot wrote it is shown to the HDF5 library here.
    return read_hdf5(path) if _is_sealed(path) else read_unsealed(path)


def _recovered(journal: Path) -> Recording:
    if not journal.exists():
        raise DataError(f"{journal}: no such file")
    if is_being_recorded(journal):
        raise DataError(f"{journal}: still being recorded: wait until that ends")
    found = read_journal(journal)
    message = (
        f"recovered {found.recording.duration_s:.3f} s from the journal of a recording that was "
        f"interrupted{found.lost}"
    )
    notice(f"{journal}: {message}")
    return replace(found.recording, details={**found.recording.details, "recovered": message})


def _is_sealed(path: Path) -> bool:
    """Whether the checksum is there and right. Raises DataError where it is there and wrong."""
    try:
        require_regular(path)
        return _verify_checksum(path)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from None


def read_hdf5(path: Path) -> Recording:
    """Read an HDF5 file in this process, which the library may crash or hang."""
    try:
        with h5py.File(path, "r") as file:
            return _recording(path, file)
    except DataError:
        raise
    # The library raises whatever it meets.
    except (OSError, KeyError, TypeError, ValueError, RuntimeError, AttributeError,
            MemoryError) as error:  # fmt: skip
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
    try:
        return Recording(
            name=metadata.name,
            position_m=samples.pop("position_m"),
            force_n=samples.pop("force_n"),
            dt_s=metadata.dt_s,
            zero=metadata.zero,
            position_delay_s=metadata.position_delay_s,
            force_delay_s=metadata.force_delay_s,
            source=metadata.source,
            details=metadata.details,
            channels={name.removeprefix(f"{_MORE}/"): found for name, found in samples.items()},
        )
    except DataError as error:
        raise DataError(f"{path}: {error}") from None


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
    declared = sum(8 * math.prod(stored.shape or ()) for stored in sets.values())
    if declared > max_unpacked_bytes(path.stat().st_size, MAX_RATIO):
        raise DataError(
            f"{path}: declares {declared >> 20} MiB of samples in {path.stat().st_size} bytes: "
            "import again"
        )


def has_checksum(path: Path) -> bool:
    """Return whether a file is a recording that springpot wrote and nobody edited since."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _CHECKSUM_BYTES))
        return file.read().startswith(_CHECKSUM)


def _verify_checksum(path: Path) -> bool:
    """Compare the bytes with the checksum after them; False: a file that others edited has none."""
    content, checksum = path.stat().st_size - _CHECKSUM_BYTES, b""
    with path.open("rb") as file:
        if content > 0:
            file.seek(content)
            checksum = file.read()
        if not checksum.startswith(_CHECKSUM):
            return False
        digest = hashlib.sha256()
        file.seek(0)
        while content > 0:
            chunk = file.read(min(content, 1 << 20))
            digest.update(chunk)
            content -= len(chunk)
    if checksum != _CHECKSUM + digest.digest():
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")
    return True


def read_recordings(paths: Iterable[Path]) -> list[Recording]:
    """Read files and folders of recordings, folders in the order of their files' names.

    Journals that a crash left in a folder are recovered.
    """
    return [read_recording(file) for file in recording_files(paths)]


def recording_files(paths: Iterable[Path]) -> list[Path]:
    """Return the files behind arguments that are files and folders of recordings.

    Raises DataError for a folder without any.
    """
    files: list[Path] = []
    for path in paths:
        files += _in_folder(path) if path.is_dir() else [path]
    return files


def _in_folder(folder: Path) -> list[Path]:
    files = list(folder.glob(f"*{RECORDING_SUFFIX}"))
    for journal in folder.glob(f"*{JOURNAL_SUFFIX}"):
        finished = journal.with_name(journal.name.removesuffix(JOURNAL_SUFFIX) + RECORDING_SUFFIX)
        if finished in files:
            notice(f"{journal}: left out, its recording was finished in {finished.name}: remove it")
        else:
            files.append(journal)
    if not files:
        raise DataError(
            f"{folder}: no {RECORDING_SUFFIX} file in this folder: `springpot import` makes them"
        )
    return sorted(files)
