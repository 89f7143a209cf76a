"""Figures of a study: ratings as boxes with letters, and psychometric functions."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from springpot.figures import ERROR, MEASURED, MUTED, PREDICTED, STYLE, svg_text
from springpot.host.wings.study.report.analysis import Analysis
from springpot.host.wings.study.report.choices import EVERYBODY, PsychometricCurve
from springpot.host.wings.study.report.scores import by_condition
from springpot.host.wings.study.statistics.psychometric import share_interval

COLOURS = (ERROR, PREDICTED, "#4f8a4c", "#8f6bb3", "#c58b2a", MUTED)


def clear_figure(width_in: float, height_in: float) -> Figure:
    """Return a figure without a background: the page's own shows, light or dark."""
    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    figure.patch.set_alpha(0.0)
    return figure


def rating_boxes(analysis: Analysis) -> str:
    """Draw boxes of people's means as SVG, by group; diamonds and numbers are means."""
    study, found = analysis.study, analysis.kept_only
    assert found is not None
    means = by_condition(study, analysis.kept)
    first, second = _factor_names(analysis)
    boxes: list[tuple[str, str, list[float], str]] = []  # group, name, values, letters
    for pair, people in means.items():
        factors = study.pair[pair].factors
        if not people:
            continue
        if not factors:
            boxes.append(("", study.pair[pair].title, list(people.values()), ""))
            continue
        group, name = factors.get(second, ""), factors[first]
        marks = found.letters.get(group, {}).get(name, "")
        boxes.append((group, name, list(people.values()), marks))
    groups = list(dict.fromkeys(group for group, *_ in boxes))
    names = list(dict.fromkeys(name for group, name, *_ in boxes))
    at, ticks, centres = 0.0, [], {}
    with mpl.rc_context(STYLE):
        figure = clear_figure(max(6.0, min(11.0, 0.6 * (len(boxes) + len(groups)))), 4.2)
        axes = figure.subplots()
        axes.patch.set_alpha(0.0)
        for group in groups:
            begin = at
            for _, name, values, marks in (box for box in boxes if box[0] == group):
                colour = COLOURS[names.index(name) % len(COLOURS)]
                _box(axes, at, values, colour)
                top = max(values)
                axes.text(at, top + 2.5, marks, ha="center", va="bottom", fontsize=8)
                axes.text(at, -9.0, f"{np.mean(values):.1f}", ha="center", va="center", fontsize=7)
                ticks.append((at, name.replace(" | ", "\n| ")))
                at += 1.0
            centres[group] = (begin + at - 1.0) / 2
            at += 0.7
        for group, centre in centres.items():
            axes.text(centre, 112.0, group, ha="center", va="bottom", fontweight="bold")
        axes.set_xticks([x for x, _ in ticks], [name for _, name in ticks], rotation=35, ha="right",
                        rotation_mode="anchor")  # fmt: skip
        axes.set_ylim(-14.0, 112.0)
        axes.set_yticks(range(0, 101, 20))
        axes.set_ylabel("rated similarity, 0 to 100")
        axes.axhline(-4.0, color=MUTED, lw=0.5)
        return svg_text(figure)


def psychometric_figure(curves: Sequence[PsychometricCurve]) -> str:
    """Return SVG text: a panel for each series; everybody's answers, and people's curves thin."""
    series = list(dict.fromkeys(curve.series for curve in curves))
    with mpl.rc_context(STYLE):
        columns = min(3, len(series))
        rows = -(-len(series) // columns)
        figure = clear_figure(max(4.2, 3.2 * columns), 2.9 * rows)
        panels = np.ravel(figure.subplots(rows, columns, squeeze=False))
        for axes, name in zip(panels, series, strict=False):
            axes.patch.set_alpha(0.0)
            for curve in (one for one in curves if one.series == name):
                _curve(axes, curve)
            axes.set_title(name, fontsize=9)
            axes.set_xlabel("level")
            axes.set_ylim(-0.03, 1.05)
            axes.set_ylabel("share of answers")
        for axes in panels[len(series) :]:
            axes.set_visible(False)
        return svg_text(figure)


def _factor_names(analysis: Analysis) -> tuple[str, str]:
    of = next((pair.factors for pair in analysis.study.pair if pair.factors), {})
    names = [*of, "", ""]
    return names[0], names[1]


def _box(axes: Axes, at: float, values: list[float], colour: str) -> None:
    """Draw a box, whiskers to the farthest within 1.5 interquartile ranges, and the mean."""
    axes.boxplot(
        [values], positions=[at], widths=0.6, manage_ticks=False, showmeans=True,
        boxprops={"color": colour}, whiskerprops={"color": colour}, capprops={"color": colour},
        medianprops={"color": colour, "lw": 1.8},
        meanprops={"marker": "D", "ms": 4, "mfc": MEASURED, "mec": MEASURED},
        flierprops={"marker": ".", "ms": 4, "mfc": colour, "mec": colour},
    )  # fmt: skip


def _curve(axes: Axes, curve: PsychometricCurve) -> None:
    x = np.linspace(curve.levels[0], curve.levels[-1], 200)
    if curve.person != EVERYBODY:
        if curve.fit is not None:
            axes.plot(x, curve.share(x), color=MUTED, lw=0.6, alpha=0.7)
        return
    share = curve.chosen / curve.trials
    low, high = share_interval(curve.chosen, curve.trials)
    bars = np.maximum(0.0, np.array([share - low, high - share]))
    axes.errorbar(curve.levels, share, bars, fmt="o", ms=4, color=MEASURED, lw=0.8, zorder=3)
    if curve.fit is None:
        return
    axes.plot(x, curve.share(x), color=PREDICTED, lw=1.8, zorder=2)
    sign = 1.0 if curve.rising else -1.0
    at = sign * curve.fit.threshold
    axes.plot(
        sorted(sign * end for end in curve.fit.threshold_interval),
        [curve.share(np.array([at]))[0]] * 2,
        color=ERROR, lw=2.5, zorder=4, solid_capstyle="butt",
    )  # fmt: skip
