"""Pictures of a stability check, as SVG text."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.host.plot_style import ERROR, MEASURED, PREDICTED, STYLE, stride, svg_text
from springpot.host.stability.closed_loop import Outcome
from springpot.host.stability.small_signal import ACTIVE, Map

_POINTS = 1500


def map_figure(found: Map, title: str) -> str:
    """sin(delta) of every cell; cells that give energy are outlined."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.6, 3.4), layout="constrained")
        axes = figure.subplots()
        most = max(0.05, float(np.abs(found.sin_delta).max()))
        image = axes.imshow(found.sin_delta, cmap="RdBu", vmin=-most, vmax=most, aspect="auto")
        for (row, column), value in np.ndenumerate(found.sin_delta):
            weight = "bold" if value < ACTIVE else "normal"
            axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7,
                      fontweight=weight)  # fmt: skip
        axes.set_xticks(range(len(found.frequency_hz)), [f"{f:.3g}" for f in found.frequency_hz])
        axes.set_yticks(range(len(found.share)), [f"{100 * s:.0f} %" for s in found.share])
        axes.axhline(float(np.sum(found.share <= 1.0)) - 0.5, color=MEASURED, lw=1.2)
        axes.set_xlabel("frequency, Hz")
        axes.set_ylabel("depth, of the trained one")
        axes.set_title(title, loc="left", fontsize=9)
        figure.colorbar(image, ax=axes, label="sin δ: below 0 gives energy", shrink=0.9)
        return svg_text(figure)


def case_figure(outcomes: Sequence[Outcome]) -> str:
    """One case: depth and force with the design hand, and the speed of every hand."""
    shown = next(item for item in outcomes if item.hand == DESIGN_HAND.name)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 2.5), layout="constrained")
        depth, force, speed = figure.subplots(1, 3)
        time_s = np.cumsum(shown.dt_s)
        step = stride(len(time_s), _POINTS)
        depth.plot(time_s[::step], 1e3 * shown.trace.position_m[::step], color=MEASURED, lw=0.9)
        force.plot(
            time_s[::step], shown.model_only_n[::step], color=MEASURED, lw=1.2, label="model"
        )
        force.plot(time_s[::step], shown.trace.felt_n[::step], color=PREDICTED, lw=0.8, ls="--",
                   label="felt")  # fmt: skip
        names = [f"{item.hand}\n{item.delay_samples}" for item in outcomes]
        speed.bar(names, [1e3 * item.hf_speed_mps for item in outcomes], color=ERROR)
        if shown.case in ("hold", "long-hold", "stiff", "glitch", "nan"):
            speed.axhline(1.0, color=PREDICTED, lw=1.0, ls="--")
        depth.set_ylabel("depth, mm")
        force.set_ylabel("force, N")
        speed.set_ylabel("speed above 15 Hz, mm/s")
        speed.set_xlabel("hand, samples of delay")
        force.legend(frameon=False, fontsize=7, loc="best")
        for axes in (depth, force):
            axes.set_xlabel("time, s")
        return svg_text(figure)
