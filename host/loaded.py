"""The C of an emitted folder, built and loaded, on arrays."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from springpot.codegen.arrays import Reals, to_float64
from springpot.codegen.errors import UsageError
from springpot.codegen.files import parse_path
from springpot.codegen.types import JsonObject
from springpot.host.files import File
from springpot.trainer.models.predict import stiffest_place_message
from springpot.trainer.recordings.recording import Recording

if TYPE_CHECKING:
    from springpot.host.native.scene_library import SceneState

_FARTHEST_M = 1.0  # of a place, as in a `Recording`
_TOO_DEEP = 10.0  # times the trained depth, as for `predict`: another unit


def load(folder: File) -> "LoadedScene":
    """Build the C of an emitted folder, or take it from the cache, and load it.

    Raises DataError where the folder is none, or of another version. Files that are not as emitted
    are a UserWarning; the result's `edited` names them.

    >>> force_n, notes = load("c").run(press.position_m)
    >>> force_n.shape == notes.shape == press.position_m.shape
    True
    """
    return LoadedScene(parse_path(folder))


class LoadedScene:
    """Result of `load`. manifest: of the emission, as in manifest.json.

    edited: files of the folder that are not as emitted.

    >>> load("c")
    LoadedScene('c', 1000 Hz)
    """

    def __init__(self, folder: Path) -> None:
        """Build or find the library of an emitted folder, and load it."""
        from springpot.host.emission.checksums import edited_files
        from springpot.host.emission.emission import require_emission
        from springpot.host.native.replay import Replay
        from springpot.host.native.scene_library import SceneLibrary

        require_emission(folder)
        self.edited = edited_files(folder)
        self._folder, self._library = folder, SceneLibrary(folder)
        self._replay = Replay(self._library)
        self.manifest: JsonObject = self._library.manifest

    def __repr__(self) -> str:
        return f"LoadedScene({str(self._folder)!r}, {1.0 / self.dt_s:.6g} Hz)"

    @property
    def dt_s(self) -> float:
        """Time between two ticks, s."""
        return float(self.manifest["dt_s"])

    def run(
        self,
        position_m: ArrayLike | Recording,
        velocity_mps: ArrayLike | None = None,
        *,
        place_m: tuple[float, float] | None = None,
    ) -> tuple[Reals, NDArray[np.int32]]:
        """Forces (n,), N, and notes (n,) of a tick for each position (n,), m, from a fresh state.

        position_m: also a `Recording` at the scene's rate. velocity_mps: (n,), m/s; by default
        backward differences of the positions. Inputs are rounded to the scene's number type, which
        the forces have. place_m: x and y, m, of a scene with a map; by default the recording's.
        Notes are bits of sp_notes.h. Raises UsageError for other shapes and rates, for a place in
        millimetres, and for one where there is no map; a UserWarning says that positions go ten
        times deeper than the trained presses, as in mm, and that a map was given no place.
        """
        place_m = self._chosen_m(place_m, position_m)
        if isinstance(position_m, Recording):
            if not np.isclose(position_m.dt_s, self.dt_s, rtol=1e-3):
                raise UsageError(
                    f"{position_m.name} is sampled at {position_m.rate_hz:g} Hz, the scene ticks "
                    f"at {1.0 / self.dt_s:g} Hz: springpot.validate replays it between the samples"
                )
            position_m = position_m.position_m
        position = to_float64(position_m, "position_m").astype(self._library.dtype)
        if position.ndim != 1 or not len(position):
            raise UsageError(f"positions of shape {position.shape}: give (n,), n above 0")
        deepest_m, trained_m = float(position.max()), float(self.manifest["trained"]["depth_m"][1])
        if deepest_m > _TOO_DEEP * trained_m > 0.0:
            doubt = f"position_m goes to {deepest_m:.4g} m, {deepest_m / trained_m:.3g} times the"
            doubt += f" trained {trained_m:.4g} m: give positions in metres"
            warnings.warn(doubt, UserWarning, stacklevel=2)
        velocity = None
        if velocity_mps is not None:
            velocity = np.asarray(velocity_mps, dtype=self._library.dtype)
            if velocity.shape != position.shape:
                raise UsageError(
                    f"velocities of shape {velocity.shape}, positions of {position.shape}: give "
                    "as many"
                )
        return self._replay.run(position, velocity, place_m=place_m)

    def _chosen_m(
        self, place_m: tuple[float, float] | None, given: ArrayLike | Recording
    ) -> tuple[float, float] | None:
        """Place to render: the stated one, else that of a recording if there is a map."""
        places = self.manifest.get("places")
        if place_m is not None:
            if not all(abs(at_m) <= _FARTHEST_M for at_m in place_m):
                raise UsageError(f"place_m = {place_m}: give x and y in metres, from -1 to 1 m")
            return place_m
        if places is None:
            return None
        if isinstance(given, Recording) and given.place_m is not None:
            return given.place_m
        x_m, y_m = places["start_m"]
        warnings.warn(f"no place: {stiffest_place_message((x_m, y_m))}", UserWarning, stacklevel=3)
        return None

    def new_state(self) -> "SceneState":
        """Memory of one object, for single ticks: `step(position_m)` gives force, N, and notes."""
        return self._library.new_state()
