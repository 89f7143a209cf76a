"""`springpot stability`: will a hand find the scene stable, and faithful."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.host.options import scene_options
from springpot.host.output import json_option, print_result, progress_bar

if TYPE_CHECKING:
    from springpot.host.stability.check import Stability
    from springpot.host.stability.closed_loop import Outcome
    from springpot.host.stability.small_signal import SmallSignalMap


@click.command(name="stability")
@scene_options
@json_option
def stability_(scene_file: Path | None, model_file: Path | None, as_json: bool) -> None:
    """Gain margin, small-signal maps, and a closed loop with three hands."""
    from springpot import stability

    with progress_bar("all cases, three hands, two delays"):
        result = stability(scene=scene_file, model=model_file)
    print_result(result.as_dict(), as_json, stability_rows(result))
    result.require_bounded()


def stability_rows(result: Stability) -> dict[str, str]:
    """A person's view: the verdict, what is not good case by case, and the extremes of the rest."""
    from springpot.host.stability.verdict import Grade, worst_by_case

    checked = result.check
    judged = [item for item in worst_by_case(result.outcomes) if item.grade != Grade.ENDS]
    doubtful = [item for item in judged if item.grade != Grade.GOOD]
    rows = {"verdict": result.recommendation}
    for item in doubtful:
        rows[f"{item.grade.word}: {_named(item.outcome)}"] = (
            f"{item.words}; {_figures(item.outcome)}"
        )
    first = next((item for item in judged if item.grade == Grade.GOOD), None)
    if first is not None:
        rows["largest deviation"] = f"{_named(first.outcome)}: {_figures(first.outcome)}"
    felt_npm, stiff_npm = checked.plan.coupling.felt_npm, result.stiff.coupling.felt_npm
    rows |= {
        "cases": f"{len(judged) - len(doubtful)} of {len(judged)} good in three hands, with the "
        "device's delay and one sample more; --json lists them",
        "holds": f"the object {checked.margin.least:.3g} times as stiff, in the "
        f"{checked.margin.hand_text}; vibrates with "
        f"{1e3 * checked.loudest.hold_speed_mps:.2g} mm/s on a short hold in the "
        f"{checked.loudest.hand} hand",
        "device": checked.plan.loop_device.words(checked.plan.dt_s),
        "passive": f"model {_cells(checked.model_map)}; scene {_cells(checked.scene_map)}",
        "stiffness felt": f"{1e-3 * felt_npm:.3g} N/mm; of an object ten times stiffer "
        + (
            f"{1e-3 * stiff_npm:.3g} N/mm"
            if stiff_npm >= felt_npm
            else "less: no coupling holds it"
        ),
    }
    return rows


def _cells(motion_map: SmallSignalMap) -> str:
    """Say in how many small motions no energy is given, within and beyond the depth."""
    (active, cells), (active_beyond, cells_beyond) = (
        motion_map.active(False),
        motion_map.active(True),
    )
    return (
        f"in {cells - active} of {cells} small motions ({cells_beyond - active_beyond} of "
        f"{cells_beyond} beyond the trained depth)"
    )


def _named(outcome: Outcome) -> str:
    return f"{outcome.case_name}, {outcome.hand}, {outcome.delay_samples} late"


def _figures(outcome: Outcome) -> str:
    """List what an outcome measured; of lost samples, what they did to the force."""
    if outcome.losses is not None:
        losses = outcome.losses
        return (
            f"{losses.error_n:.2f} N off 10 ms after samples are back, "
            f"{losses.above_n:.2f} N above after 5 ms; {1e3 * losses.returned_j:.1f} mJ back of "
            f"{1e3 * losses.stored_j:.1f} stored"
        )
    slow_mps = outcome.vibration.lf_speed_mps
    below = "" if slow_mps is None else f"{1e3 * slow_mps:.2f} below, "
    return (
        f"{1e3 * outcome.max_depth_m:.2f} mm, {outcome.max_force_n:.2f} N, "
        f"{1e3 * outcome.hf_speed_mps:.2f} mm/s above 15 Hz, {below}"
        f"{outcome.fidelity_percent:.1f} % fidelity error"
    )
