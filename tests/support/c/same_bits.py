"""The emitted C and its reference in numpy, compared bit for bit."""

import tempfile
from pathlib import Path

import numpy as np

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.reference import run_reference
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.validation.compared import proxy_positions


def checked_library(plan: Plan) -> SceneLibrary:
    """The plan's C as it is emitted, built; its self-test passes."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in emit_files(plan).items():
            Path(folder, name).write_text(text)
        library = SceneLibrary(Path(folder))
    assert library.selftest() == 0
    return library


def require_same_bits(
    plan: Plan, position_m: np.ndarray, velocity_mps: np.ndarray | None = None, find: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Assert that forces, notes and the self-test agree; forces, N, and notes of the C.

    find: the reference finds where the proxy is, which takes long; else the C says
    where, which decides how long it takes and never what it gives.
    """
    position = position_m.astype(plan.dtype)
    velocity = differentiate(position, plan.dt_s) if velocity_mps is None else velocity_mps
    library = checked_library(plan)
    assert library.state_bytes == state_bytes(plan)
    force_n, notes = Replay(library).run(position, velocity)
    predicted_m = None if find else proxy_positions(plan, library, position, velocity)
    reference = run_reference(plan, position, predicted_m)
    bits = f"u{force_n.itemsize}"
    np.testing.assert_array_equal(force_n.view(bits), reference.force_n.view(bits))
    np.testing.assert_array_equal(notes, reference.notes)
    return force_n, notes
