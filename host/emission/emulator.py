"""A scene's C on an emulated board: the same calls as on this machine, and their instructions."""

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from springpot import SpringpotError
from springpot.codegen.arrays import Reals
from springpot.codegen.errors import MismatchError
from springpot.host.emission.boards import Board, build_batch, emulator_of

CALL_IDLE, CALL_RESET = 1, 2  # CALL_IDLE, CALL_RESET of sp_batch.c
_SHIFT = 8  # an instruction takes 2^8 ns of the emulated time: several counts of every counter
_OVERFLOWED = 0xFFFFFFFF  # OVERFLOWED of sp_batch.c
_LONGEST_S = 600.0


@dataclass(frozen=True, eq=False)
class Batch:
    """What each call returned on the board: force_n, notes, instructions; shapes (n,)."""

    force_n: Reals
    notes: NDArray[np.int32]
    instructions: NDArray[np.int64]


def steps(position_m: Reals, velocity_mps: Reals) -> NDArray[np.void]:
    """Return plain ticks, one a position: rows (n,) of calls to make, in the scene's type.

    `call` of a row takes CALL_IDLE, for which `dt_s` is, and CALL_RESET.
    """
    real = position_m.dtype
    names = [("call", "<u4"), ("position_m", real), ("velocity_mps", real), ("dt_s", real)]
    rows = np.zeros(len(position_m), dtype=np.dtype(names, align=real.itemsize == 8))
    rows["position_m"], rows["velocity_mps"] = position_m, velocity_mps
    return rows


def run_batch(folder: Path, board: Board, rows: NDArray[np.void]) -> Batch:
    """Make the calls of `steps` on the emulated board, from a fresh state.

    Raises UsageError without the tools, MismatchError where the scene's self-test fails there.
    """
    real = rows.dtype["position_m"]
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        place = Path(scratch)
        program = build_batch(folder, board, place)
        rows.tofile(place / "calls.bin")
        emulate(board, program, place)
        names = [("force_n", real), ("notes", "<i4"), ("counts", "<u4")]
        row = np.dtype(names, align=real.itemsize == 8)
        returned = np.fromfile(place / "returns.bin", dtype=row)
    if len(returned) != 1 + len(rows):
        raise SpringpotError(
            f"{board.name}: {max(len(returned) - 1, 0)} of {len(rows)} calls returned: the "
            "firmware stopped"
        )
    if differs := int(returned["notes"][0]):
        raise MismatchError(
            f"{board.name}: the self-test differs at golden tick {differs - 1}: report the compiler"
        )
    counts = returned["counts"].astype(np.int64)
    if counts.max() >= _OVERFLOWED:
        raise SpringpotError(
            f"{board.name}: call {int(counts.argmax()) - 1} took more instructions than its "
            "counter can hold: count on another board"
        )
    per_count = 1e9 / board.counter_hz / (1 << _SHIFT)
    return Batch(
        force_n=returned["force_n"][1:],
        notes=returned["notes"][1:],
        instructions=np.round((counts[1:] - counts[0]) * per_count).astype(np.int64),
    )


def emulate(board: Board, program: Path, place: Path) -> None:
    """Run a program on the emulated board; its files are in `place`, and "returns.bin" is written.

    Raises UsageError without the emulator, SpringpotError where it fails.
    """
    command = [
        emulator_of(board), "-M", board.name, *board.options, "-display", "none",
        "-monitor", "none", "-serial", "null",
        "-semihosting-config", "enable=on,target=native", "-icount", f"shift={_SHIFT}",
        "-kernel", str(program),
    ]  # fmt: skip
    try:
        result = subprocess.run(
            command, cwd=place, capture_output=True, text=True, check=False, timeout=_LONGEST_S
        )
    except subprocess.TimeoutExpired:
        raise SpringpotError(f"{board.name}: no end after {_LONGEST_S:g} s of emulation") from None
    if result.returncode != 0 or not (place / "returns.bin").exists():
        raise SpringpotError(f"{board.name}: the emulator failed: {result.stderr.strip()[:300]}")
