"""Recordings -> CSV and MAT files, which come back bit for bit by `springpot import`."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np

from springpot import Recording, UsageError
from springpot.basics import Samples, write_file, written_aside
from springpot.modelling import SIGN_RULE

ExportFormat = Literal["csv", "mat"]
_RULE = {"sign_rule": SIGN_RULE}


def write_mat(
    path: Path, recording: Recording, time_s: Samples, metadata: Mapping[str, Any]
) -> None:
    """Write three vectors, (n,), those of the place, and the metadata as JSON: variables."""
    from scipy.io import savemat

    content = {
        "time_s": time_s,
        "position_m": recording.position_m,
        "force_N": recording.force_n,
        **recording.place_columns(),
        "metadata": json.dumps(metadata, sort_keys=True),
    }
    savemat(path, content, appendmat=False, oned_as="column", do_compression=True)


def export_recording(folder: Path, recording: Recording, form: ExportFormat) -> Path:
    """Write one recording into a folder and return the file.

    CSV: time_s, position_m, force_N and the place, if it is known, as shortest round-trip decimals;
    metadata go beside it as JSON. MAT: v5, the same vectors, and the metadata as a variable.
    Raises UsageError where the file exists or cannot be written.
    """
    path = folder / f"{recording.name}.{form}"
    with _new_file(path) as aside:
        if form == "csv":
            _write_csv(aside, recording)
            metadata = json.dumps(recording.metadata() | _RULE, indent=2, sort_keys=True) + "\n"
            write_file(path.with_suffix(".json"), metadata.encode())
        else:
            write_mat(aside, recording, _time_s(recording), recording.metadata() | _RULE)
    return path


def write_prediction(folder: Path, recording: Recording, predicted_n: Samples) -> Path:
    """Write time, position, measured and predicted force, (n,), N, of a recording as a CSV file.

    Raises UsageError where the file exists or cannot be written.
    """
    path = folder / f"{recording.name}.csv"
    with _new_file(path) as aside:
        _write_csv(aside, recording, {"predicted_N": predicted_n})
    return path


@contextmanager
def _new_file(path: Path) -> Iterator[Path]:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists():
            raise UsageError(f"{path}: exists already: remove it or choose another --out")
        with written_aside(path) as aside:
            yield aside
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}: choose another --out") from None


def _time_s(recording: Recording) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.arange(len(recording.position_m), dtype=np.float64) * recording.dt_s


def _write_csv(path: Path, recording: Recording, more: Mapping[str, Samples] | None = None) -> None:
    columns = {
        "time_s": _time_s(recording),
        "position_m": recording.position_m,
        "force_N": recording.force_n,
        **recording.place_columns(),
        **(more or {}),
    }
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(columns) + "\n")
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)
