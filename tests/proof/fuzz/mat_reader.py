"""MAT and foreign HDF5 files: read in this process, so that the fuzzer sees the branches taken.

The project reads them in a process of its own: what does not survive that in a copy of this
process is refused, as users would see it. What hangs here is tried once more as they would.
"""

import contextlib
import io
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
from proof.fuzz.reader import Reader
from proof.fuzz.text_reader import read_import
from scipy.io import savemat
from support.files.malformed import TIME_S

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats import arrays


def seeds() -> Iterator[tuple[str, bytes]]:
    """Plain arrays, a structure and a cell array, uncompressed; HDF5."""
    columns = {"time_s": TIME_S[:20], "position_mm": TIME_S[:20], "force_N": TIME_S[:20]}
    for name, content in {
        "plain": columns,
        "structure": {"rig": columns},
        "cells": {"rig": np.array([TIME_S[:20], "text"], dtype=object)},
        "matrix": {"data": np.stack(list(columns.values()))},
    }.items():
        memory = io.BytesIO()
        savemat(memory, content)
        yield name, memory.getvalue()
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        for name, values in columns.items():
            file.create_dataset(name, data=values, fletcher32=True)
    yield "hdf5", memory.getvalue()


def read(content: bytes, folder: Path) -> None:
    """Import it, its arrays read here."""
    with mock.patch.object(arrays, "_npz_apart", _here):
        as_users(content, folder)


def as_users(content: bytes, folder: Path) -> None:
    """Import it, its arrays read in a process of their own."""
    read_import(content, folder, "a.mat")


def _here(path: Path, kind: str) -> bytes:
    """What the process of its own does, but for its limits."""
    if not _survives(path, kind):
        raise DataError(f"{path}: it crashes the reader")
    try:
        return arrays.arrays_as_npz(path, kind)
    except Exception as error:  # whatever the libraries raise on a damaged file
        raise DataError(f"{path}: {error}") from None


def _survives(path: Path, kind: str) -> bool:
    """Whether a copy of this process, with the limits of users, comes through reading it.

    Hardly a second passes without a crash of scipy's reader, which would end the fuzzer.
    """
    child = os.fork()
    if child:
        return os.waitpid(child, 0)[1] == 0
    for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL):
        signal.signal(number, signal.SIG_DFL)
    with contextlib.suppress(Exception):
        arrays.limit_reader(path)
        arrays.arrays_as_npz(path, kind)
    os._exit(0)


READER = Reader(
    seeds,
    read,
    words=(
        "MATLAB 5.0 MAT-file", "\\x00\\x01IM", "time_s", "position_mm", "force_N",
        "\\x0e\\x00\\x00\\x00", "\\x0f\\x00\\x00\\x00", "\\x89HDF\\x0d\\x0a\\x1a\\x0a",
    ),
    as_users=as_users,
)  # fmt: skip
