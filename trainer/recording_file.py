"""Recordings as HDF5 files: one file a recording, a 1-D data set a channel, facts as attributes."""

import hashlib
import json
import os
from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np

from springpot.runtime_c.errors import DataError
from springpot.trainer.recording import SIGN_RULE, Recording

SCHEMA = 1
SUFFIX = ".h5"
# Behind the HDF5 file stand these bytes and its SHA-256: the library itself can crash or hang on a
# flipped byte. HDF5 readers ignore them; a program that edits the file cuts them off.
_SEAL = b"springpot sha256"
_SEAL_BYTES = len(_SEAL) + hashlib.sha256().digest_size
_CHANNEL_UNITS = {"position_m": "m", "force_n": "N"}


def write_recording(path: Path, recording: Recording) -> None:
    """Write `recording` aside and rename it to `path`, so that a reader never sees half a file."""
    aside = path.with_name(path.name + ".part")
    with h5py.File(aside, "w", track_order=True) as file:
        file.attrs["schema"] = SCHEMA
        file.attrs["name"] = recording.name
        file.attrs["dt_s"] = recording.dt_s
        file.attrs["sign_rule"] = SIGN_RULE
        file.attrs["zero"] = recording.zero
        file.attrs["position_delay_s"] = recording.position_delay_s
        file.attrs["force_delay_s"] = recording.force_delay_s
        file.attrs["source"] = recording.source
        file.attrs["details"] = json.dumps(dict(recording.details), sort_keys=True)
        for channel, unit in _CHANNEL_UNITS.items():
            samples = getattr(recording, channel)
            dataset = file.create_dataset(
                channel, data=samples, compression="gzip", shuffle=True, fletcher32=True
            )
            dataset.attrs["unit"] = unit
    with aside.open("r+b") as written:
        digest = hashlib.file_digest(written, "sha256").digest()
        written.write(_SEAL + digest)
        written.flush()
        os.fsync(written.fileno())
    aside.replace(path)


def read_recording(path: Path) -> Recording:
    """Read one recording. Raises DataError with the file's name where it cannot be used."""
    try:
        _check_seal(path)
        with h5py.File(path, "r") as file:
            schema = int(file.attrs["schema"])
            if schema > SCHEMA:
                raise DataError(
                    f"{path}: recording schema {schema}, this springpot reads up to {SCHEMA}: "
                    "upgrade springpot"
                )
            for channel, unit in _CHANNEL_UNITS.items():
                found = file[channel].attrs["unit"]
                if found != unit:
                    raise DataError(
                        f"{path}: {channel} is in {found!r}, not {unit!r}: import again"
                    )
            return Recording(
                name=str(file.attrs["name"]),
                position_m=np.asarray(file["position_m"], dtype=np.float64),
                force_n=np.asarray(file["force_n"], dtype=np.float64),
                dt_s=float(file.attrs["dt_s"]),
                zero=file.attrs["zero"],
                position_delay_s=float(file.attrs["position_delay_s"]),
                force_delay_s=float(file.attrs["force_delay_s"]),
                source=str(file.attrs["source"]),
                details=json.loads(file.attrs["details"]),
            )
    except FileNotFoundError:
        raise DataError(f"{path}: no such file") from None
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise DataError(
            f"{path}: not a springpot recording ({reason}): make one with `springpot import`"
        ) from None


def _check_seal(path: Path) -> None:
    """Compare the bytes with the seal behind them; a file that others edited has none."""
    content, seal = path.stat().st_size - _SEAL_BYTES, b""
    with path.open("rb") as file:
        if content > 0:
            file.seek(content)
            seal = file.read()
        if not seal.startswith(_SEAL):
            return
        digest = hashlib.sha256()
        file.seek(0)
        while content > 0:
            chunk = file.read(min(content, 1 << 20))
            digest.update(chunk)
            content -= len(chunk)
    if seal != _SEAL + digest.digest():
        raise DataError(f"{path}: damaged, its bytes differ from those written: import it again")


def read_recordings(paths: Iterable[Path]) -> list[Recording]:
    """Read files and folders of recordings, folders in the order of their files' names."""
    recordings = []
    for path in paths:
        files = sorted(path.glob(f"*{SUFFIX}")) if path.is_dir() else [path]
        if not files:
            raise DataError(
                f"{path}: no {SUFFIX} file in this folder: `springpot import` makes them"
            )
        recordings += [read_recording(file) for file in files]
    return recordings
