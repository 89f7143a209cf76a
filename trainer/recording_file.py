"""Recordings as HDF5 files: one file a recording, a 1-D data set a channel, facts as attributes."""

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
    with aside.open("rb") as written:
        os.fsync(written.fileno())
    aside.replace(path)


def read_recording(path: Path) -> Recording:
    """Read one recording. Raises DataError with the file's name where it cannot be used."""
    try:
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
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise DataError(
            f"{path}: not a springpot recording ({error}): make one with `springpot import`"
        ) from None


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
