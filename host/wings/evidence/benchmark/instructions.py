"""Instructions of a tick of a point's C on the emulated board of the benchmark's target."""

import tempfile
from pathlib import Path
from typing import Any

from springpot import Recording, SpringpotError, read_model
from springpot.basics import Number, Target
from springpot.emission import RESYNC, backward_velocity, make_plan, write_emission
from springpot.host.wings.evidence.benchmark.measure import bench_scene
from springpot.native import Board, default_board, missing, run_batch, steps

TICKS = 4000


def uncounted(target: Target) -> str:
    """Why instructions cannot be counted here; nothing where they can."""
    if target == "wasm32":
        return "WebAssembly is timed in node, not counted"
    board = default_board(target)
    return missing(board) if board else "a PC has no emulated board: give --target"


def count_instructions(
    model_file: Path, number: Number, recording: Recording, target: Target
) -> dict[str, Any]:
    """`instructions`: the most that a tick took over the recording's first 4000; restarts apart.

    None where they cannot be counted; `instructions_why` then says why.
    """
    board = default_board(target)
    if board is None or uncounted(target):
        return {"instructions": None, "instructions_why": uncounted(target)}
    try:
        counted = _counted(model_file, number, recording, board)
    except SpringpotError as error:
        return {"instructions": None, "instructions_why": str(error)}
    return {"instructions": counted, "instructions_why": f"emulated {board.name}"}


def _counted(model_file: Path, number: Number, recording: Recording, board: Board) -> int:
    scene = bench_scene(number, board.target)
    plan = make_plan(read_model(model_file), scene, accept_unsafe=True)
    position = recording.position_m[:TICKS].astype(plan.dtype)
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        folder = Path(scratch) / "c"
        write_emission(plan, scene, model_file, folder)
        calls = steps(position, backward_velocity(position, plan.dt_s))
        batch = run_batch(folder, board, calls)
    # A restart fills its filters once, and is no tick of a loop.
    return int(batch.instructions[(batch.notes & RESYNC) == 0].max())
