"""Recordings as MAT files of version 5, which come back bit for bit by `springpot import`."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from springpot import Recording
from springpot.basics import Samples


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
