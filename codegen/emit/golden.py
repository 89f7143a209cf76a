"""Golden vectors: a short press that visits what the C can do, and the reference's forces."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import wrap_items
from springpot.codegen.plan import Plan
from springpot.codegen.reference import run_reference
from springpot.codegen.stages.stage import Probe
from springpot.codegen.types import RealType

LEG_TICKS = 60
_GLITCH_M = 0.5
_PLACE_FRACTIONS = (0.375, 0.75)  # of the map: where the second press of a golden motion is
# Depths as shares of the trained range; below 0 is free air where there is contact.
_DEPTH_FRACTIONS = (-0.05, 0.4, 0.15, 0.9, 1.0, 0.7, 1.1, 0.3, -0.02, 0.6, 0.0)


def golden_positions(plan: Plan) -> NDArray[np.float32 | np.float64]:
    """Return the positions of the self-test, (n,), m: smooth strokes, a glitch, NaNs and a jump."""
    trained = plan.model.trained
    base_m = 0.0 if plan.contact else trained.min_m
    span_m = trained.max_m - base_m
    ramp = np.arange(LEG_TICKS) / LEG_TICKS
    smooth = ramp * ramp * (3.0 - 2.0 * ramp)
    legs = [start + (end - start) * smooth for start, end in pairwise(_DEPTH_FRACTIONS)]
    positions: NDArray[np.float32 | np.float64] = (base_m + span_m * np.concatenate(legs)).astype(
        plan.dtype
    )
    positions[LEG_TICKS + 7] += plan.dtype(_GLITCH_M)
    positions[2 * LEG_TICKS + 11 : 2 * LEG_TICKS + 15] = np.nan
    positions[7 * LEG_TICKS :] += plan.dtype(3.0 * float(plan.guard.max_step_m))
    return positions


def golden_places(plan: Plan) -> list[tuple[int, tuple[float, float]]]:
    """Return the site that the self-test chooses before a tick; none for a model without a map."""
    if not plan.has_places or (law := plan.model.hammerstein) is None or law.places is None:
        return []
    first_m, last_m = law.places.first_m, law.places.last_m
    x_m, y_m = (
        (first_m + np.array(_PLACE_FRACTIONS) * (last_m - first_m)).astype(plan.dtype).tolist()
    )
    return [(3 * LEG_TICKS, (x_m, y_m))]


def differentiate(position_m: Reals, dt_s: float) -> Reals:
    """Velocities that a device would report, (n,), m/s: backward differences, 0 at the first."""
    velocity_mps: Reals = np.diff(position_m, prepend=position_m[:1]) / position_m.dtype.type(dt_s)
    return velocity_mps


def probe_inputs(probe: Probe, dtype: RealType) -> Reals:
    """Made-up inputs, (probe.inputs,): multiples of 1/128, exact in every number type."""
    inputs: Reals = (37 * np.arange(probe.inputs) % 101).astype(dtype) / dtype(128)
    return inputs


def golden_arrays(plan: Plan) -> list[str]:
    """Render the self-test's inputs and the reference's forces as bits: a NaN has no C literal."""
    positions = golden_positions(plan)
    columns = {"golden_position": positions}
    run = run_reference(plan, positions, places=golden_places(plan))
    columns["golden_force"] = run.force_n
    if plan.features is not None and (probe := plan.features.probe()) is not None:
        columns["golden_probe"] = probe.sums(probe_inputs(probe, plan.dtype))
    bits, c_type = (np.uint32, "uint32_t") if plan.real == "float" else (np.uint64, "uint64_t")
    parts = []
    for name, values in columns.items():
        items = [f"0x{pattern:x}u" for pattern in values.view(bits).tolist()]
        parts.append(f"static const {c_type} {name}[{len(items)}] = {{")
        parts += [*wrap_items(items), "};"]
    parts.append(f"static const uint8_t golden_notes[{len(run.notes)}] = {{")
    return [*parts, *wrap_items(map(str, run.notes.tolist())), "};"]
