"""Read a recording that carries no checksum of ours: run as a process of its own.

Prints it as one NPZ file: its metadata as JSON, position, force and the channels.
"""

import io
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from springpot.trainer.recordings.reader_limits import read_apart, run_reader
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_hdf5 import read_hdf5


def read_unsealed(path: Path) -> Recording:
    """Read it there. Raises DataError with the file's name where it cannot be used."""
    with np.load(io.BytesIO(read_apart(path, __name__)), allow_pickle=False) as stored:
        metadata = json.loads(str(stored["metadata"]))
        names = metadata.pop("channels")
        return Recording(
            position_m=stored["position_m"],
            force_n=stored["force_n"],
            channels={name: stored[f"channel{k}"] for k, name in enumerate(names)},
            **metadata,
        )


def as_npz(recording: Recording) -> bytes:
    """The recording as an NPZ file, for `read_unsealed`."""
    metadata = recording.metadata() | {"channels": list(recording.channels)}
    channels: dict[str, Any] = {
        f"channel{k}": samples for k, samples in enumerate(recording.channels.values())
    }
    memory = io.BytesIO()
    np.savez(
        memory,
        metadata=json.dumps(metadata),
        position_m=recording.position_m,
        force_n=recording.force_n,
        **channels,
    )
    return memory.getvalue()


if __name__ == "__main__":
    run_reader(Path(sys.argv[1]), lambda path: as_npz(read_hdf5(path)))
