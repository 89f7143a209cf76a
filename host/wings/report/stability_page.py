"""The stability check as one self-contained HTML page, and its figures."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from springpot import Stability
from springpot.basics import write_file
from springpot.checks import ACTIVE, DESIGN_HAND, QUIET_MPS, Grade, Map, Outcome, judged_cases
from springpot.figures import ERROR, MEASURED, PREDICTED, STYLE, page_text, stride, svg_text

_POINTS = 1500
_DARK = 0.6  # of the colour scale: text in darker cells is white
_LEAST_MPS = 1e-5


def map_figure(found: Map, title: str, most: float) -> str:
    """The map as a picture of its own."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.6, 3.4), layout="constrained")
        draw_map(figure.subplots(), found, title, most)
        return svg_text(figure)


def draw_map(axes: Axes, found: Map, title: str, most: float) -> None:
    """sin(delta) of every cell, coloured from -most to most; those that give energy are bold."""
    image = axes.imshow(found.sin_delta, cmap="RdBu", vmin=-most, vmax=most, aspect="auto")
    for (row, column), value in np.ndenumerate(found.sin_delta):
        weight = "bold" if value < ACTIVE else "normal"
        axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7,
                  fontweight=weight, color=ink_on(value / most))  # fmt: skip
    axes.set_xticks(range(len(found.frequency_hz)), [f"{f:.3g}" for f in found.frequency_hz])
    axes.set_yticks(range(len(found.share)), [f"{100 * s:.0f} %" for s in found.share])
    axes.axhline(float(np.sum(found.share <= 1.0)) - 0.5, color=MEASURED, lw=1.2)
    axes.set(xlabel="frequency, Hz", ylabel="depth, of the trained one")
    axes.set_title(title, loc="left", fontsize=9)
    axes.figure.colorbar(image, ax=axes, label="sin δ: below 0 gives energy", shrink=0.9)


def scale_of(*maps: Map) -> float:
    """What the colours of maps that are compared end at, either way."""
    return max(0.05, *(float(abs(item.sin_delta).max()) for item in maps))


def ink_on(share: float) -> str:
    """Colour of text in a cell whose value is this share of the scale, -1 to 1."""
    return "white" if abs(share) > _DARK else MEASURED


@dataclass(frozen=True)
class CaseScale:
    """The limits that every case is drawn within."""

    depth_mm: tuple[float, float]
    force_n: tuple[float, float]
    speed_mmps: tuple[float, float]

    @staticmethod
    def of(outcomes: Sequence[Outcome]) -> "CaseScale":
        """Limits that hold all outcomes, the speeds on a logarithmic axis."""
        depths = [1e3 * item.trace.position_m for item in outcomes]
        forces = [force for item in outcomes for force in (item.model_only_n, item.trace.felt_n)]
        speeds = [max(item.hf_speed_mps, QUIET_MPS) for item in outcomes]
        return CaseScale(_span(depths), _span(forces), (1e3 * _LEAST_MPS, 2e3 * max(speeds)))


def case_figures(outcomes: Sequence[Outcome], scale: CaseScale) -> list[str]:
    """One case: depth and force with the design hand, and the speed of every hand."""
    shown = next(item for item in outcomes if item.hand == DESIGN_HAND.name)
    time_s = np.cumsum(shown.played.scenario.dt_s)
    step = stride(len(time_s), _POINTS)

    def depth(axes: Axes) -> None:
        axes.plot(time_s[::step], 1e3 * shown.trace.position_m[::step], color=MEASURED, lw=0.9)
        axes.set(xlabel="time, s", ylabel="depth, mm", ylim=scale.depth_mm)

    def force(axes: Axes) -> None:
        axes.plot(time_s[::step], shown.model_only_n[::step], color=MEASURED, lw=1.2, label="model")
        axes.plot(time_s[::step], shown.trace.felt_n[::step], color=PREDICTED, lw=0.8, ls="--",
                  label="felt")  # fmt: skip
        axes.set(xlabel="time, s", ylabel="force, N", ylim=scale.force_n)
        axes.legend(frameon=False, fontsize=7, loc="best")

    def speed(axes: Axes) -> None:
        names = [f"{item.hand}\n{item.delay_samples}" for item in outcomes]
        axes.bar(names, [1e3 * max(item.hf_speed_mps, _LEAST_MPS) for item in outcomes],
                 color=ERROR)  # fmt: skip
        if shown.played.still:
            axes.axhline(1e3 * QUIET_MPS, color=PREDICTED, lw=1.0, ls="--")
        axes.set(xlabel="hand, samples of delay", ylabel="speed above 15 Hz, mm/s", yscale="log",
                 ylim=scale.speed_mmps)  # fmt: skip

    with mpl.rc_context(STYLE):
        pictures = []
        for draw in (depth, force, speed):
            figure = Figure(figsize=(3.3, 2.4), layout="constrained")
            draw(figure.subplots())
            pictures.append(svg_text(figure))
        return pictures


def _span(values: Sequence[np.ndarray]) -> tuple[float, float]:
    low, high = min(map(np.min, values)), max(map(np.max, values))
    room = 0.05 * max(high - low, 1e-9)
    return float(low - room), float(high + room)


def write_stability_report(found: Stability, path: Path) -> None:
    """Write the page."""
    scale = CaseScale.of(found.whole)
    names = dict.fromkeys(item.outcome.case for item in judged_cases(found.whole))
    cases = []
    for name in names:
        outcomes = [outcome for outcome in found.whole if outcome.case == name]
        cases.append({"name": name, "rows": outcomes, "pictures": case_figures(outcomes, scale)})
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
    most = scale_of(*maps.values())
    return {
        "stability": found.as_dict(),
        "device_words": plan.loop_device.words(plan.dt_s),
        "loop_grade": Grade.GOOD if found.check.stable else Grade.BAD,
        "maps": [map_figure(item, title, most) for title, item in maps.items()],
        "judged": judged_cases(found.outcomes),
    }
