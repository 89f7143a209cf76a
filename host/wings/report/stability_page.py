"""The stability check as one self-contained HTML page."""

from pathlib import Path
from typing import Any

from springpot import Stability
from springpot.basics import write_file
from springpot.checks import Grade, judged_cases
from springpot.figures import page_text
from springpot.host.wings.report import stability_figures as figures


def write_stability_report(found: Stability, path: Path) -> None:
    """Write the page."""
    scale = figures.CaseScale.of(found.whole)
    names = dict.fromkeys(item.outcome.case for item in judged_cases(found.whole))
    cases = []
    for name in names:
        outcomes = [outcome for outcome in found.whole if outcome.case == name]
        cases.append(
            {"name": name, "rows": outcomes, "pictures": figures.case_figures(outcomes, scale)}
        )
    context = {
        "title": found.check.plan.scene.name,
        **stability_section(found),
        "cases": cases,
        "losses": [item for item in judged_cases(found.outcomes) if item.outcome.losses],
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, page_text("stability.html", context, "springpot.host.wings.report").encode())


def stability_section(found: Stability) -> dict[str, Any]:
    """What any page on a check shows: the figures, the maps, and all cases, the worst first."""
    maps = {"the model alone": found.check.model_map, "the whole scene": found.check.scene_map}
    plan = found.check.plan
    most = figures.scale_of(*maps.values())
    return {
        "stability": found.as_dict(),
        "device_words": plan.loop_device.words(plan.dt_s),
        "loop_grade": Grade.GOOD if found.check.stable else Grade.BAD,
        "maps": [figures.map_figure(item, title, most) for title, item in maps.items()],
        "judged": judged_cases(found.outcomes),
    }
