"""Planted defects: each makes the analysis of one scene fail, or the analysis proves nothing."""

from dataclasses import dataclass
from pathlib import Path

from proof.eva.analysis import Analysis
from proof.eva.scene_analysis import analyse_scene
from proof.eva.scenes import ProvedScene, emit_scene


@dataclass(frozen=True)
class Defect:
    """A change of one place in the emitted C of a scene."""

    what: str
    scene: ProvedScene
    file: str
    right: str
    wrong: str


_PASSIVE = ProvedScene("hammerstein", "off", "float32")
_DEVICE = ProvedScene("hammerstein", "proxy", "float32", contact="always", velocity="device")
_FOREST = ProvedScene("rf-history", "off", "float32")
_RADIAL = ProvedScene("rbf-fd", "off", "float32")

DEFECTS = (
    Defect(
        "an index one too far",
        _PASSIVE,
        "sp_curve.h",
        "terms + place.piece * (degree + 1)",
        "terms + (place.piece + 1) * (degree + 1)",
    ),
    Defect(
        "a forest's step one too far",
        _FOREST,
        "sp_forest.h",
        "(step >> SP_FOREST_SLOT_BITS) + right",
        "(step >> SP_FOREST_SLOT_BITS) + 2 * right + 1",
    ),
    Defect(
        "a bin looked for one too far",
        _FOREST,
        "sp_bins.h",
        "from < begin_max ? from : begin_max",
        "from < n ? from : n",
    ),
    Defect(
        "the force's clamp removed",
        _PASSIVE,
        "sp_output.h",
        "state->force_n = sp_output_clamp(config, force_n, notes);",
        "state->force_n = force_n;",
    ),
    Defect(
        "the maximum not clamped",
        _PASSIVE,
        "sp_output.h",
        "return force_n > config->max_n   ? config->max_n",
        "return force_n > config->max_n   ? force_n",
    ),
    Defect(
        "a position that is no number let through",
        _PASSIVE,
        "sp_guard.h",
        "return x == x && x >= config->min_m",
        "return !(x < config->min_m)",
    ),
    Defect("an infinite position let through", _PASSIVE, "sp_guard.h", "&& x <= config->max_m", ""),
    Defect(
        "a time that is not finite let through",
        _PASSIVE,
        "sp_number.h",
        "return x == x && x > (sp_real)0 && x <= SP_REAL_MAX;",
        "return x > (sp_real)0;",
    ),
    Defect(
        "a curve left without a value", _PASSIVE, "sp_curve.h", "        values[i] = value;\n", ""
    ),
    Defect(
        "a sum that begins anywhere",
        _RADIAL,
        "sp_taps.h",
        "sum[SP_TAPS_SUMS] = {0};",
        "sum[SP_TAPS_SUMS];",
    ),
    Defect(
        "a pole that grows",
        _PASSIVE,
        "sp_poles.h",
        "h + (rise - loss * h)",
        "h + (rise + loss * h)",
    ),
    Defect(
        "a piece of a curve beyond the last",
        _PASSIVE,
        "sp_curve.h",
        "(sp_real)(n_pieces - 1)",
        "(sp_real)(n_pieces + 1)",
    ),
    Defect(
        "a device's velocity that is no number let through",
        _DEVICE,
        "sp_guard_velocity.h",
        "return v == v &&",
        "return v != v ||",
    ),
)


def analyse_defect(defect: Defect, folder: Path) -> Analysis:
    """Plant it in a scene of its own under `folder`, and analyse that.

    Raises ValueError where the C no longer has what it changes.
    """
    out = emit_scene(defect.scene, folder / defect.what.replace(" ", "-"))
    changed = out / defect.file
    text = changed.read_text()
    if defect.right not in text:
        raise ValueError(f"{defect.what}: {defect.file} has no {defect.right!r} any more")
    changed.write_text(text.replace(defect.right, defect.wrong, 1))
    return analyse_scene(out)
