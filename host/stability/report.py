"""The stability check as one self-contained HTML page."""

from pathlib import Path

from springpot.host.page import page_text
from springpot.host.stability import figures
from springpot.host.stability.check import Stability
from springpot.host.stability.closed_loop import worst_losses


def write_stability_report(found: Stability, path: Path) -> None:
    """Write the page."""
    checked = found.check
    names = list(dict.fromkeys(outcome.case for outcome in found.whole))
    cases = []
    for name in names:
        outcomes = [outcome for outcome in found.whole if outcome.case == name]
        cases.append({"name": name, "rows": outcomes, "picture": figures.case_figure(outcomes)})
    context = {
        "title": checked.plan.scene.name,
        "metadata": found.as_dict(),
        "maps": [
            figures.map_figure(checked.model_map, "the model alone"),
            figures.map_figure(checked.scene_map, "the whole scene"),
        ],
        "cases": cases,
        "losses": worst_losses(found.outcomes),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page_text("stability.html", context), encoding="utf-8")
