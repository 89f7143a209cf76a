"""An emitted scene as a loaded library, also one that is built for a look at it only."""

import json
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.header import prefix_public_names
from springpot.codegen.emit.source import ABI_VERSION
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.messages import counted_noun
from springpot.codegen.native.c_library import CLibrary, declarations
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.plan import Plan
from springpot.codegen.types import CData, JsonObject, RealType
from springpot.runtime_c.paths import INCLUDE


def read_manifest(folder: Path) -> JsonObject:
    """Read all metadata of an emitted folder. Raises DataError where manifest.json is none."""
    file = folder / "manifest.json"
    try:
        metadata: JsonObject = json.loads(file.read_text(encoding="utf-8"))
        if {"accept_unsafe", "hash"} <= metadata.keys() and len(metadata["sources"]) == 1:
            return metadata
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass
    raise DataError(f"{file}: no manifest: emit again")


def scene_prefix(folder: Path) -> str:
    """The prefix of an emitted folder's C: NAME of NAME.c and NAME.h. Raises as `read_manifest`."""
    return Path(str(read_manifest(folder)["sources"][0])).stem


def write_port(folder: Path, real: str, files: Iterable[Path], out: Path) -> None:
    """Write a port's files for the C of an emitted folder, and two headers that they include.

    Where a file speaks of the scene it gets the scene's prefix. real: "float" or "double".
    """
    prefix = scene_prefix(folder)
    for file in files:
        text = file.read_text(encoding="utf-8").replace('"sp_scene.h"', f'"{prefix}_scene.h"')
        (out / file.name).write_text(
            prefix_public_names(text, prefix), encoding="utf-8", newline="\n"
        )
    (out / f"{prefix}_scene.h").write_text(
        f'#include "{prefix}.h"\n#include "sp_real.h"\n\n'
        f"#define SP_PERIOD_S {prefix.upper()}_DT_S\n",
        encoding="utf-8", newline="\n",
    )  # fmt: skip
    (out / "sp_real.h").write_text(
        (INCLUDE / real / "sp_real.h").read_text(encoding="utf-8"), encoding="utf-8", newline="\n"
    )


def build_scene(folder: Path) -> Path:
    """Build an emitted folder's shared library, or return the one built before."""
    return shared_library([folder / f"{scene_prefix(folder)}.c"], [folder])


class SceneLibrary:
    """One scene's C, loaded; `new_state` gives it memory.

    manifest: of the folder; its fields on the C are of the C that runs, edited or not.
    """

    def __init__(self, folder: Path) -> None:
        """Build, load and ask the scene's C for its version, manifest and size of state."""
        self.path = build_scene(folder)
        self._prefix = scene_prefix(folder)
        self.loaded = CLibrary(self.path, declarations([folder / f"{self._prefix}.h"]))
        abi_version = self.function("abi_version")()
        if abi_version != ABI_VERSION:
            raise DataError(
                f"{folder}: C API version {abi_version}, springpot has {ABI_VERSION}: emit again"
            )
        manifest = self.loaded.ffi.string(self.function("manifest")())
        self.manifest = read_manifest(folder) | json.loads(manifest)
        self.dtype: RealType = np.float32 if self.manifest["number"] == "float32" else np.float64
        self.real = "float" if self.dtype is np.float32 else "double"
        self.state_bytes: int = self.function("state_size")()

    def function(self, name: str) -> CData:
        return getattr(self.loaded.c, f"{self._prefix}_{name}")

    def address(self, name: str) -> int:
        """Address of the C function `name`, for C that calls it."""
        return self.loaded.address(self.function(name))

    def selftest(self) -> int:
        """0, or 1 + the first golden tick with other bits."""
        return int(self.function("selftest")())

    def new_state(self, place_m: tuple[float, float] | None = None) -> "SceneState":
        """Return a fresh state; place_m: x and y where it is pressed, m, if the scene has a map."""
        state = SceneState(self)
        if place_m is not None:
            state.place(place_m)
        return state


class SceneState:
    """One state of a scene; not for two threads at once."""

    def __init__(self, library: SceneLibrary) -> None:
        self._library, self._loaded = library, library.loaded
        self._state = self._loaded.memory(library.state_bytes, f"{library._prefix}_state")
        self._force = self._loaded.ffi.new(f"{library.real}[3]")
        library.function("init")(self._state)

    @property
    def address(self) -> int:
        """Address of the state, for C that calls sp_step."""
        return self._loaded.address(self._state)

    def real_at(self, offset: int) -> float:
        """The number that the state holds at `offset` bytes: for tests of a tick's memory."""
        cast = self._loaded.ffi.cast
        return float(cast(f"{self._library.real} *", cast("char *", self._state) + offset)[0])

    def reset(self) -> None:
        """Forget the past; unlatch the watchdog."""
        self._library.function("reset")(self._state)

    def place(self, place_m: tuple[float, float]) -> None:
        """Press at x and y, m, from the next contact on.

        Raises UsageError if the object is the same everywhere.
        """
        if not hasattr(self._loaded.c, f"{self._library._prefix}_place"):
            raise UsageError("this scene has no map of places: leave the place out")
        self._library.function("place")(self._state, *place_m)

    def step(self, position_m: float, velocity_mps: float = 0.0) -> tuple[float, int]:
        """One tick: force (N) and notes."""
        notes = self._library.function("step")(self._state, position_m, velocity_mps, self._force)
        return self._force[0], notes

    def idle(self, dt_s: float) -> tuple[float, int]:
        """No sample came for dt_s: force (N) and notes. Raises UsageError for a bad dt_s."""
        notes = self._library.function("idle")(self._state, dt_s, self._force)
        if notes < 0:
            raise UsageError(f"dt_s = {dt_s}: give a positive time step in s")
        return self._force[0], notes

    def run(self, position_m: Reals, velocity_mps: Reals | None = None) -> tuple[Reals, int]:
        """A batch: forces, shape (n,), N, and all notes. Inputs are rounded to the scene's type."""
        position = np.ascontiguousarray(position_m, dtype=self._library.dtype)
        if velocity_mps is not None and len(velocity_mps) != len(position):
            raise UsageError(
                f"velocity_mps: {len(velocity_mps)} for {counted_noun(len(position), 'position')}: "
                "give one for each"
            )
        force = np.empty_like(position)
        array = self._loaded.array
        velocity = self._loaded.ffi.NULL
        if velocity_mps is not None:
            held = np.ascontiguousarray(velocity_mps, dtype=self._library.dtype)
            velocity = array(held)
        notes = self._library.function("run")(
            self._state, len(position), array(position), velocity, array(force)
        )
        return force, notes


def build_and_load(plan: Plan) -> SceneLibrary:
    """Return the plan's C without its self-test, built and loaded."""
    with emitted_folder_of(plan) as folder:
        return SceneLibrary(folder)


@contextmanager
def emitted_folder_of(plan: Plan) -> Iterator[Path]:
    """The folder of the plan's C, without its self-test."""
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        for name, text in emit_files(plan, selftest=False).items():
            (Path(scratch) / name).write_text(text, encoding="utf-8", newline="\n")
        yield Path(scratch)


def without_coupling(plan: Plan) -> Plan:
    """Return the same scene with coupling and smoothing off: the model by itself."""
    if plan.couple is None and plan.smooth_alpha is None:
        return plan
    scene = plan.scene
    return make_plan(
        plan.model,
        replace(
            scene,
            coupling=replace(scene.coupling, mode="off"),
            smoothing=replace(scene.smoothing, time_constant_s=0.0),
        ),
    )
