"""The emitted C of three axes with other numbers in its tables: one build for many models."""

import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from springpot.codegen.emit.files import emit_files
from springpot.codegen.plan.plan import Plan
from springpot.host.native.scene_library import SceneLibrary

_TABLES = ("amounts", "materials", "areas", "branch_loss", "depth_branch_loss", "stop_radius")
Fault = tuple[str, str]  # text of the emitted files, and what stands there instead


class SlidingC:
    """A scene in double with a lateral force."""

    def __init__(self, library: SceneLibrary) -> None:
        self._library = library
        ffi = library.loaded.ffi
        ffi.cdef("".join(f"double *test_{name}(void);" for name in _TABLES))

    def take(self, plan: Plan) -> None:
        """Take the numbers of another model of the same shape."""
        for name, values in tables(plan).items():
            at = getattr(self._library.loaded.c, f"test_{name}")()
            flat = np.ascontiguousarray(values, dtype=np.float64).ravel()
            self._library.loaded.ffi.memmove(at, self._library.loaded.array(flat), flat.nbytes)

    def force_n(self, position_m: np.ndarray) -> np.ndarray:
        """Force of each tick, (n, 3), N, from a fresh state at x, y and depth, (n, 3), m."""
        state = self._library.new_state()
        return np.array([state.step3(at)[0] for at in position_m])


def tables(plan: Plan) -> dict[str, np.ndarray]:
    """Tables of a plan by their names in the C; those that its shape has not are empty."""
    lateral = plan.lateral
    its = lateral.of_one
    loss = {step.names.prefix: step.loss for step in its.steps}
    return {
        "amounts": lateral.placed.amounts,
        "materials": lateral.placed.materials,
        "areas": lateral.areas,
        "branch_loss": loss.get("branch", np.zeros(0)),
        "depth_branch_loss": loss.get("depth_branch", np.zeros(0)),
        "stop_radius": its.radius,
    }


@contextmanager
def sliding(plan: Plan, faults: Sequence[Fault] = ()) -> Iterator[SlidingC]:
    """Build the C of a plan, in which faults may be planted."""
    files = emit_files(plan)
    for text, planted in faults:
        name = next(name for name, its in files.items() if text in its)
        files[name] = files[name].replace(text, planted)
    for name in _TABLES:
        open_table = rf"static const sp_real {name}\["
        files["sp_tables.h"] = re.sub(open_table, f"static sp_real {name}[", files["sp_tables.h"])
    have = "".join(
        f"double *test_{name}(void);\n"
        f"double *test_{name}(void) {{ return {name if values.size else 'NULL'}; }}\n"
        for name, values in tables(plan).items()
    )
    files["sp_scene.c"] += have
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (Path(folder) / name).write_text(text)
        yield SlidingC(SceneLibrary(Path(folder)))
