"""Recordings -> CSV and MAT files, which come back bit for bit by `springpot import`."""

import json
from pathlib import Path
from typing import Literal

import numpy as np

from springpot.codegen.atomic_write import write_file, written_aside
from springpot.codegen.errors import UsageError
from springpot.trainer.recordings.recording import SIGN_RULE, Recording

ExportFormat = Literal["csv", "mat"]
_RULE = {"sign_rule": SIGN_RULE}


def export_recording(folder: Path, recording: Recording, form: ExportFormat) -> Path:
    """Write one recording into a folder and return the file.

    CSV: time_s, position_m, force_N as shortest round-trip decimals; metadata go beside it as JSON.
    MAT: v5, the same three vectors, and the metadata as variables.
    Raises UsageError where the file exists or cannot be written.
    """
    path = folder / f"{recording.name}.{form}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if path.exists():
            raise UsageError(f"{path}: exists already: remove it or choose another --out")
        with written_aside(path) as aside:
            if form == "csv":
                _write_csv(aside, recording)
            else:
                _write_mat(aside, recording)
        if form == "csv":
            metadata = json.dumps(recording.metadata() | _RULE, indent=2, sort_keys=True) + "\n"
            write_file(path.with_suffix(".json"), metadata.encode())
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}: choose another --out") from None
    return path


def _time_s(recording: Recording) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.arange(len(recording.position_m), dtype=np.float64) * recording.dt_s


def _write_csv(path: Path, recording: Recording) -> None:
    columns = (_time_s(recording), recording.position_m, recording.force_n)
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write("time_s,position_m,force_N\n")
        rows = zip(*(column.tolist() for column in columns), strict=True)
        file.writelines(f"{t!r},{x!r},{f!r}\n" for t, x, f in rows)


def _write_mat(path: Path, recording: Recording) -> None:
    from scipy.io import savemat

    content = {
        "time_s": _time_s(recording),
        "position_m": recording.position_m,
        "force_N": recording.force_n,
        "metadata": json.dumps(recording.metadata() | _RULE, sort_keys=True),
    }
    savemat(path, content, appendmat=False, oned_as="column", do_compression=True)
