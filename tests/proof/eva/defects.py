"""Planted defects: each makes the analysis of one scene fail, or the analysis proves nothing."""

import json
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from proof.eva.analysis import Analysis, Known
from proof.eva.scene_analysis import analyse_scene, real_type
from proof.eva.scenes import ProvedScene, emit_scene

from springpot.codegen.emit.header import apply_prefix

_PASSIVE = ProvedScene("hammerstein", "off", "float32")


@dataclass(frozen=True)
class Defect:
    """A change of one place in the emitted C of a scene."""

    what: str
    file: str
    right: str
    wrong: str
    scene: ProvedScene = _PASSIVE
    of_laws: bool = False  # seen where growth and the latched fall are looked at


_FOREST = ProvedScene("past-positions", "off", "float32")
_RADIAL = ProvedScene("rbf-fd", "off", "float32")

DEFECTS = (
    Defect("an index one too far", "sp_curve.h", "nodes + place.interval * 2 * n_curves",
           "nodes + (place.interval + 1) * 2 * n_curves"),
    Defect("a forest's step one too far", "sp_forest.h", "(step >> SP_FOREST_SLOT_BITS) + right",
           "(step >> SP_FOREST_SLOT_BITS) + 2 * right + 1", _FOREST),
    Defect("a bin looked for one too far", "sp_bins.h", "from < begin_max ? from : begin_max",
           "from < n ? from : n", _FOREST),
    Defect("the force's clamp removed", "sp_output.h",
           "force_n = sp_output_clamp(config, force_n, notes);", ""),
    Defect("a force that grows twice as fast", "sp_output.h",
           "const sp_real upper_n = before_n + slew_n;",
           "const sp_real upper_n = before_n + (sp_real)2 * slew_n;", of_laws=True),
    Defect("a latched force that falls a thousand times too slowly", "sp_output.h",
           "const sp_real step = config->latch_fall_n * ticks;",
           "const sp_real step = config->latch_fall_n * ticks * (sp_real)0.001;", of_laws=True),
    Defect("the maximum not clamped", "sp_output.h",
           "return force_n > config->max_n   ? config->max_n",
           "return force_n > config->max_n   ? force_n"),
    Defect("a position that is no number let through", "sp_guard.h",
           "return x == x && x >= config->min_m", "return !(x < config->min_m)"),
    Defect("an infinite position let through", "sp_guard.h", "&& x <= config->max_m", ""),
    Defect("a time that is not finite let through", "sp_number.h",
           "return x == x && x > (sp_real)0 && x <= SP_REAL_MAX;", "return x > (sp_real)0;"),
    Defect("a curve left without a value", "sp_curve.h", "        values[i] = value[i]",
           "        values[0] = value[i]"),
    Defect("a sum that begins anywhere", "sp_taps.h", "sum[SP_TAPS_LANES] = {0};",
           "sum[SP_TAPS_LANES];", _RADIAL),
    Defect("a pole that grows", "sp_poles.h", "h + (rise - loss * h)", "h + (rise + loss * h)"),
    Defect("a piece of a curve beyond the last", "sp_curve.h", "(sp_real)(n_intervals - 1u)",
           "(sp_real)(n_intervals + 1u)"),
    Defect("latched ticks without a bound", "sp_silence.h",
           "overrun < SP_SILENCE_MAX_LATCHED_TICKS ? overrun : SP_SILENCE_MAX_LATCHED_TICKS;",
           "overrun;"),
)  # fmt: skip


def plant_defect(defect: Defect, folder: Path) -> Path:
    """Emit the defect's scene under `folder` with the defect in it; returns its folder.

    Raises ValueError where the C no longer has what it changes.
    """
    out = emit_scene(defect.scene, folder / defect.what.replace(" ", "-"))
    changed = out / "sp.c"
    text, number = changed.read_text(), real_type(json.loads((out / "manifest.json").read_text()))
    right, wrong = (apply_prefix(part, "sp", number) for part in (defect.right, defect.wrong))
    if right not in text:
        raise ValueError(f"{defect.what}: {changed} has no {right!r} any more")
    changed.write_text(text.replace(right, wrong, 1))
    return out


def analyse_defect(defect: Defect, folder: Path, known: Known = MappingProxyType({})) -> Analysis:
    """Plant it in a scene of its own, and analyse that. Raises as `plant_defect`."""
    return analyse_scene(plant_defect(defect, folder), laws=defect.of_laws, known=known)
