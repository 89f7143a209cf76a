"""A recording as one HDF5 file: a 1-D data set a channel, and its metadata.

The SHA-256 of the file stands in its user block, which HDF5 readers skip, and is compared
before the library reads: on a flipped byte that can hang, whatever checksums its own format has
(tried with those of HDF5 1.10: 1 of some 3 000 flips did not end).
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from pydantic import BaseModel, Field, ValidationError

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.files import atomic_write
from springpot.trainer.recordings.recording import SIGN_RULE, Recording, Zero

RECORDING_SCHEMA = 1
_UNITS = {"position_m": "m", "force_n": "N"}
_EXTRA_CHANNELS = "channels/"  # group of the channels beside these two
_CHUNK_SAMPLES = 1 << 17
_USER_BLOCK = 512  # bytes
# Memory that a file may claim: this much, and so many times its own size. A log of an hour at 1 kHz
# compresses to a twentieth; twice and more of that is left.
_MAX_CLAIMED_BYTES, _MAX_COMPRESSION = 1 << 26, 48
_MAGIC = b"springpot recording, SHA-256 of what follows: "
_REMEDY = "make one with `springpot import`"
GIVE_RECORDING = "give a recording; `springpot import` makes them"


class _Metadata(BaseModel, allow_inf_nan=False):
    """Fields of `Recording` beside its samples, as they are stored."""

    name: str
    dt_s: float = Field(gt=0)
    source: str
    details: dict[str, Any]
    zero: Zero = "none"
    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    session: str = ""
    start_s: float | None = None
    place_x_m: float | None = None
    place_y_m: float | None = None


def write_recording(path: Path, recording: Recording, *, overwrite: bool = True) -> None:
    """Write a recording aside, sync and rename it to `path`: a reader never sees half a file.

    overwrite: False raises FileExistsError if `path` exists, even if it came meanwhile.
    Raises OSError, and leaves nothing aside, if that fails.
    """
    with atomic_write(path, overwrite=overwrite, durable=True) as aside:
        with h5py.File(aside, "w", track_order=True, userblock_size=_USER_BLOCK) as file:
            metadata = {name: getattr(recording, name) for name in _Metadata.model_fields}
            # HDF5 holds UTF-8: of a path that is none, the bytes as \xff, for people.
            metadata["source"] = recording.source.encode("utf-8", "backslashreplace").decode()
            metadata["details"] = json.dumps(dict(recording.details), sort_keys=True)
            metadata |= {"schema": RECORDING_SCHEMA, "sign_rule": SIGN_RULE}
            for key, value in metadata.items():
                if value is not None:
                    file.attrs[key] = value
            channels = {name: getattr(recording, name) for name in _UNITS}
            channels |= {
                f"{_EXTRA_CHANNELS}{name}": values for name, values in recording.channels.items()
            }
            for name, samples in channels.items():
                stored = file.create_dataset(
                    name, data=samples, chunks=(min(len(samples), _CHUNK_SAMPLES),),
                    compression="gzip", compression_opts=1, shuffle=True, fletcher32=True,
                )  # fmt: skip
                if name in _UNITS:
                    stored.attrs["unit"] = _UNITS[name]
        digest = _digest(aside)
        with aside.open("r+b") as raw:
            raw.write(_MAGIC + digest + b"\n")


def is_recording(path: Path) -> bool:
    """Return whether a file begins as a recording of springpot's."""
    with path.open("rb") as file:
        return file.read(len(_MAGIC)) == _MAGIC


def read_hdf5(path: Path) -> Recording:
    """Read a recording. Raises DataError for a file that is damaged, or none."""
    with path.open("rb") as raw:
        head = raw.read(_USER_BLOCK)
    if not head.startswith(_MAGIC):
        raise DataError(f"{path}: not a springpot recording: {_REMEDY}")
    if head[len(_MAGIC) :].rstrip(b"\0\n") != _digest(path):
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")
    try:
        with h5py.File(path, "r") as file:
            metadata = dict(file.attrs)
            require_stored_here(path, file)
            names = [
                *_UNITS,
                *(f"{_EXTRA_CHANNELS}{name}" for name in file.get(_EXTRA_CHANNELS, ())),
            ]
            samples = {
                n.removeprefix(_EXTRA_CHANNELS): np.asarray(file[n], dtype=np.float64)
                for n in names
            }
    # The library raises whatever it meets in a file that others have made.
    except DataError:
        raise
    except (
        OSError, KeyError, TypeError, ValueError, RuntimeError, AttributeError, MemoryError,
    ) as error:  # fmt: skip
        reason = " ".join(str(error).split())
        raise DataError(f"{path}: not a springpot recording ({reason}): {_REMEDY}") from None
    metadata["details"] = parse_metadata(path, metadata.get("details", ""))
    return build_recording(path, metadata, samples)


def require_stored_here(path: Path, file: h5py.File) -> None:
    """Raise DataError if reading the file would read others, or take far more memory than it has.

    A dataset without stored chunks takes no room in the file: 7 kB can claim gigabytes.
    """
    claimed_bytes = 0

    def visit(name: str, node: object) -> None:
        nonlocal claimed_bytes
        if isinstance(node, h5py.Dataset):
            if node.external or node.is_virtual:
                raise DataError(f"{path}: {name} is stored in another file: export one file")
            claimed_bytes += node.nbytes

    file.visititems(visit)
    stored_bytes = path.stat().st_size
    if claimed_bytes > _MAX_CLAIMED_BYTES + _MAX_COMPRESSION * stored_bytes:
        raise DataError(
            f"{path}: claims {claimed_bytes >> 20} MiB of values in {stored_bytes >> 10} KiB of "
            "file: damaged, or not a recording"
        )


def _digest(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(_USER_BLOCK)
        return hashlib.file_digest(file, "sha256").hexdigest().encode()


def parse_metadata(path: Path, text: str | bytes) -> dict[str, Any]:
    """Parse a table of JSON. Raises DataError for anything else."""
    try:
        metadata = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        metadata = None
    if not isinstance(metadata, dict):
        raise DataError(f"{path}: not a springpot recording (metadata is no JSON): {_REMEDY}")
    return metadata


def build_recording(
    path: Path, metadata: Mapping[str, Any], samples: Mapping[str, Samples]
) -> Recording:
    """Return the recording of stored metadata and samples, each (n,), of a file.

    Raises DataError for a field that is missing or of another type, and for a later schema.
    """
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in metadata.items()}
    schema = plain.get("schema")
    if isinstance(schema, int) and schema > RECORDING_SCHEMA:
        raise DataError(
            f"{path}: recording schema {schema}, this springpot reads up to {RECORDING_SCHEMA}: "
            "upgrade springpot"
        )
    try:
        checked = _Metadata.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        what = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise DataError(f"{path}: not a springpot recording ({what}): {_REMEDY}") from None
    fields: dict[str, Any] = {**checked.model_dump(), **{name: samples[name] for name in _UNITS}}
    channels = {name: values for name, values in samples.items() if name not in _UNITS}
    try:
        return Recording(**fields, channels=channels)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
