"""The stability check as one self-contained HTML page."""

from pathlib import Path

from springpot.host.page import page_text
from springpot.host.stability import figures
from springpot.host.stability.check import Stability
from springpot.host.stability.closed_loop import Outcome


def write_stability_report(found: Stability, path: Path) -> None:
    """Write the page."""
    checked = found.check
    whole = [outcome for outcome in found.outcomes if outcome.losses is None]
    names = list(dict.fromkeys(outcome.case for outcome in whole))
    cases = []
    for name in names:
        outcomes = [outcome for outcome in whole if outcome.case == name]
        cases.append({"name": name, "rows": outcomes, "picture": figures.case_figure(outcomes)})
    context = {
        "title": checked.plan.scene.name,
        "metadata": found.as_dict(),
        "maps": [
            figures.map_figure(checked.model_map, "the model alone"),
            figures.map_figure(checked.scene_map, "the whole scene"),
        ],
        "cases": cases,
        "losses": worst_losses(found),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page_text("stability.html", context), encoding="utf-8")


def worst_losses(found: Stability) -> list[Outcome]:
    """Of each case that loses samples the hand and delay with the greatest change of force."""
    worst: dict[str, Outcome] = {}
    for outcome in found.outcomes:
        if outcome.losses is None:
            continue
        before = worst.get(outcome.case)
        if before is None or before.losses is None or _beyond(outcome) > _beyond(before):
            worst[outcome.case] = outcome
    return list(worst.values())


def _beyond(outcome: Outcome) -> tuple[int, float]:
    assert outcome.losses is not None
    losses = outcome.losses
    return losses.zero_ticks - losses.clean_zero_ticks, losses.force_step_n
