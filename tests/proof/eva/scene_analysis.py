"""The emitted C of a scene, or of any folder that `springpot emit` wrote."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from proof.eva.analysis import Analysis, Known, Precision, Question, alarms_in, answer, unbounded_in

DRIVER = Path(__file__).with_name("driver.c")
_PRECISION = Precision(
    apart={
        "sp_guard_accept": 60, "sp_guard_plausible": 10,
        "sp_guard_held_fraction": 20, "sp_is_valid_dt": 10, "sp_idle": 10, "sp_step": 8,
        "sp_hammerstein_static_force": 12, "sp_forest_traverse": 4000, "sp_forest_sum": 200,
        "sp_bins_search": 20,
    },
    by_result=("sp_guard_plausible", "sp_is_valid_dt"),
    parts={
        "sp_poles_step": 30, "sp_slow_poles": 30, "sp_poles_by_depth": 30,
        "sp_slow_poles_by_depth": 30, "sp_smooth": 30, "sp_tool_velocity": 30, "sp_rbf_force": 4,
    },
)  # fmt: skip
_OPTIONS = (
    "-eva-auto-loop-unroll", "32", "-eva-split-limit", "10000",
    # Longer than the force takes from 0 to its maximum in steps of the slew limit.
    "-eva-widening-delay", "8", "-eva-widening-period", "1",
)  # fmt: skip
# The portable traversal of a forest: no vector units.
_FLAGS = ("-I.", "-U__x86_64__", "-DSP_FOREST_X86_H")
_PLACE = """    if (Frama_C_interval(0, 1)) {
        sp_place(&state, anything(), anything());
    }
"""
# Bounds that the analysis tries, one after the other, for a number that grows in the loop.
_BOUNDS = tuple(8.0**power for power in range(-3, 23))


def analyse_scene(
    folder: Path, timeout_s: float = 600.0, laws: bool = False, known: Known = MappingProxyType({})
) -> Analysis:
    """Analyse the C in a folder, of the prefix sp; writes the driver and Eva's log beside it.

    laws: of growth and of the latched fall too, which takes several times as long.
    """
    manifest = json.loads((folder / "manifest.json").read_text())
    limits = manifest["limits"]
    files = sorted(folder.glob("sp.[ch]"))
    text = "".join(path.read_text() for path in files)
    floats = [limits["min_n"], limits["max_n"], *_BOUNDS, *(-bound for bound in _BOUNDS)]
    driver = DRIVER.read_text()
    for mark, value in (
        ("@FLOATS@", ", ".join(repr(float(bound)) for bound in floats)),
        ("@WHOLE@", ", ".join(map(str, sorted(_last_places(text))))),
        ("@LAWS@", str(int(laws))),
        ("@PLACE@", _PLACE if "void sp_place(" in text else ""),
        ("sp_real", real_type(manifest)),
    ):
        driver = driver.replace(mark, value)
    (folder / "prove.c").write_text(driver)
    question = Question(
        folder,
        Path("prove.c"),
        [*files, folder / "prove.c"],
        _FLAGS,
        (*_OPTIONS, *_PRECISION.options(text)),
        told=lambda said: (*alarms_in(said), *unbounded_in(said)),
    )
    return answer(question, known, timeout_s)


def real_type(manifest: Mapping[str, Any]) -> str:
    """Return what an emitted scene writes for sp_real."""
    return {"float32": "float", "float64": "double"}[manifest["number"]]


def _last_places(text: str) -> set[int]:
    """Last indices of the arrays in the state: where a ring's place ends."""
    sizes = re.findall(r"(?:float|double) \w+\[(?:2 \* )?(\d+)\];", text)
    return {int(size) - 1 for size in sizes} | {1}
