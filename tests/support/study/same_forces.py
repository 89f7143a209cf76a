"""The calls of a study's log, made again through its scenes."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from springpot import MismatchError
from springpot.host.wings.study.session.switched import PlacedNotes
from springpot.loop import IDLE, NONE, RESET
from springpot.native import Replay, SceneLibrary
from springpot.validation import bits_differ


def require_same_forces(log: str, channels: Any, scenes: Sequence[SceneLibrary | None]) -> int:
    """Make every call of a log again through its scenes; how many ticks were compared.

    Raises MismatchError where one gives another force or another note.
    """
    found, call = PlacedNotes.of(channels["notes"]), channels["call"].astype(np.int64)
    compared = 0
    for place, scene in enumerate(scenes, 1):
        rows = (found.place == place) & ((call & NONE) == 0)
        if scene is None or not rows.any():
            continue
        calls = {name: values[rows] for name, values in channels.items()}
        calls["call"] = np.where(found.reset[rows], RESET, 0) | (call[rows] & IDLE)
        force_n, notes = Replay(scene).repeat(calls)
        logged_n = calls["returned_n"].astype(force_n.dtype)
        other = bits_differ(force_n, logged_n) | (notes != found.notes[rows])
        if wrong := int(np.sum(other)):
            raise MismatchError(
                f"{log}: {wrong} of {int(rows.sum())} ticks of place {place} give another force "
                "than the emitted C: the log or the scene was changed"
            )
        compared += int(rows.sum())
    return compared
