"""Several scenes in one session of the C loop, one of them felt: sp_switch.h."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.basics import Samples
from springpot.loop import StepFunctions, loop_library
from springpot.native import CLibrary, SceneLibrary

MAX_PLACES = 3  # beside place 0, where nothing is felt
# Far below what a hand feels, above what a smoothed force leaves behind.
_FADED_N = 1e-3


class SwitchedScenes:
    """Scenes in places 1, 2 and 3 of one loop; place 0 gives no force. All of one number type."""

    def __init__(self, real: str, latency_s: float = 0.0) -> None:
        """real: "float" or "double"; latency_s: what every step lasts, whichever scene it is."""
        self._library: CLibrary = loop_library(real)
        self._c = self._library.c
        self._switch = self._library.ffi.new(
            "sp_switch *", {"latency_ns": round(1e9 * latency_s), "faded_n": _FADED_N}
        )
        self._kept: list[Any] = []

    def steps(self) -> StepFunctions:
        """Return what a loop calls."""
        kept = (self._switch, self)
        return StepFunctions.of(self._library, "sp_switch", self._switch, kept)

    def place(self, scenes: Sequence[SceneLibrary | None]) -> None:
        """Put scenes into places 1, 2, ...; None: without one. Nothing may be felt meanwhile."""
        assert self.active == 0 and self.wanted == 0, "scenes are changed where nothing is felt"
        assert len(scenes) <= MAX_PLACES
        self._kept = []
        for k in range(MAX_PLACES):
            scene = scenes[k] if k < len(scenes) else None
            self._switch.scenes[k + 1] = self._pointers(scene)

    def want(self, place: int) -> None:
        """Feel this place as soon as the tool is above the surface."""
        self._c.sp_switch_want(self._switch, place)

    @property
    def wanted(self) -> int:
        return int(self._switch.wanted)

    @property
    def active(self) -> int:
        """Which place is felt."""
        return int(self._c.sp_switch_active(self._switch))

    @property
    def overruns(self) -> int:
        """Steps that took longer than the latency, so far."""
        return int(self._switch.overruns)

    def _pointers(self, scene: SceneLibrary | None) -> dict[str, Any]:
        null = self._library.ffi.NULL
        if scene is None:
            return dict.fromkeys(("step", "idle", "reset", "state"), null)
        state = scene.new_state()
        self._kept += [scene, state]
        found = {name: self._library.pointer(scene.address(name))
                 for name in ("step", "idle", "reset")}  # fmt: skip
        return {**found, "state": self._library.pointer(state.address)}


@dataclass(frozen=True, eq=False)
class PlacedNotes:
    """Notes of a log's rows, taken apart: the scenes' own, the place (n,), whether it was reset."""

    notes: Any
    place: Any
    reset: Any

    @classmethod
    def of(cls, notes: Samples) -> "PlacedNotes":
        """Take the column of a log apart."""
        whole = notes.astype(np.int64)
        return cls(whole & 0xFF, (whole >> 8) & 3, (whole & (4 << 8)) != 0)
