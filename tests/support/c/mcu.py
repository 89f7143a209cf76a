"""What the tests on emulated boards share: a target's scenes, motion, skipping without tools."""

import dataclasses

import numpy as np
import pytest

from springpot.codegen.scene import Scene
from springpot.host.emission.boards import BOARDS, missing
from support.small import DT_S, press, scene, wandering

TICKS = 10_000


def need(*names: str) -> None:
    """Skip, with what to install, where a board cannot be built or emulated here."""
    for name in names:
        if lacking := missing(BOARDS[name]):
            pytest.skip(lacking)


def target_scene(target: str, **options: str) -> Scene:
    chosen = scene(**options)
    return dataclasses.replace(chosen, runtime=dataclasses.replace(chosen.runtime, target=target))


def long_motion() -> np.ndarray:
    """10 000 ticks: presses of a validation, deeper than trained, then a hand with bad samples."""
    clean = [press(hz, 0.014, cycles=2) for hz in (0.5, 2.0)]
    clean.append(press(1.0, 0.035))
    motion = np.concatenate([*clean, np.full(200, -1e-3), wandering(7, TICKS)])[:TICKS]
    assert len(motion) == TICKS and DT_S == 1e-3
    return motion
