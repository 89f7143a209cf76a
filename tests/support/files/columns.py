"""Recordings as files of other programs: CSV and MAT."""

from pathlib import Path

import numpy as np
from scipy.io import savemat

from springpot.trainer.recordings.recording import Recording


def write_columns(path: Path, recording: Recording) -> Path:
    """Write time, position, force and place by the ending of a file, in digits that come back."""
    columns = {
        "time_s": recording.dt_s * np.arange(len(recording.force_n)),
        "position_m": recording.position_m,
        "force_N": recording.force_n,
    }
    if recording.place_m is not None:
        place = np.broadcast_to(recording.place_m, (len(recording.force_n), 2)).T
        columns |= dict(zip(("place_x_m", "place_y_m"), place, strict=True))
    if path.suffix == ".mat":
        savemat(path, columns, oned_as="column")
    else:
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        path.write_text("\n".join(lines) + "\n")
    return path
