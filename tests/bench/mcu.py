"""Flash, RAM, stack and instructions of a tick of models on emulated boards, and their parity.

    python tests/bench/mcu.py MODEL.spm ... --recording REC ... [--mode off tool]

A model in the scene's defaults for the board's target; counts are the maximum over the ticks of
the recordings (restarts apart) beside the bound from the tables.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.plan.units import instruction_bound
from springpot.codegen.reference.notes import RESYNC
from springpot.codegen.scene import Coupling, Runtime, Scene
from springpot.host.emission.emission import emit
from springpot.host.native.replay import Replay, replayed_accuracy
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.wings.boards.boards import BOARDS
from springpot.host.wings.boards.emulator import run_batch, steps
from springpot.trainer.recordings.recording_file import read_recordings

TICKS = 10_000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="+", type=Path)
    parser.add_argument("--recording", nargs="+", type=Path, required=True)
    parser.add_argument("--mode", nargs="+", default=["auto"])
    options = parser.parse_args()
    recordings = read_recordings(options.recording)
    position = np.concatenate([item.position_m for item in recordings])[:TICKS]
    print(
        "model mode board | flash RAM stack | most bound restart bound | ticks differing | RMSE N"
    )
    for model in options.models:
        for mode in options.mode:
            for name in BOARDS:
                report(model, mode, name, position.astype(np.float32), recordings)


def report(model: Path, mode: str, name: str, position, recordings) -> None:
    board = BOARDS[name]
    scene = Scene(
        1, model.stem, model.name, runtime=Runtime(target=board.target), coupling=Coupling(mode)
    )
    with tempfile.TemporaryDirectory() as scratch:
        emission = emit(scene, model, Path(scratch) / "c", accept_unsafe=True)
        velocity = backward_velocity(position, emission.plan.dt_s)
        replay = Replay(SceneLibrary(emission.folder))
        force_n, notes = replay.run(position, velocity)
        batch = run_batch(emission.folder, board, steps(position, velocity))
        found = replayed_accuracy(emission.plan, replay, recordings)
    differ = int(np.sum((batch.force_n.view("u4") != force_n.view("u4")) | (batch.notes != notes)))
    restarts = (batch.notes & RESYNC) != 0
    bound = instruction_bound(emission.plan)
    print(
        f"{model.stem} {mode} {name} | {emission.footprint.flash_bytes} {emission.ram_bytes} "
        f"{emission.footprint.stack_bytes} | {batch.instructions[~restarts].max()} {bound.tick} "
        f"{batch.instructions[restarts].max()} {bound.restart} | {differ} of {len(position)} | "
        f"{found.rmse_n:.4f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
