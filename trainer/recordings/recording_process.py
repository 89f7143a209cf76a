"""Read a recording that carries no checksum of ours: run as a process of its own.

Prints it as one NPZ file: its metadata as JSON, position, force and the channels.
"""

import dataclasses
import io
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.reader_limits import limit_reader, read_apart, refuse
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_hdf5 import read_hdf5

_SAMPLES = ("position_m", "force_n", "channels")


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
    """What `read_unsealed` reads."""
    metadata = {
        item.name: getattr(recording, item.name)
        for item in dataclasses.fields(recording)
        if item.name not in _SAMPLES
    }
    channels: dict[str, Any] = {
        f"channel{k}": samples for k, samples in enumerate(recording.channels.values())
    }
    memory = io.BytesIO()
    np.savez(
        memory,
        metadata=json.dumps(metadata | {"channels": list(recording.channels)}),
        position_m=recording.position_m,
        force_n=recording.force_n,
        **channels,
    )
    return memory.getvalue()


if __name__ == "__main__":
    limit_reader(Path(sys.argv[1]))
    try:
        sys.stdout.buffer.write(as_npz(read_hdf5(Path(sys.argv[1]))))
    except DataError as error:
        refuse(error)
