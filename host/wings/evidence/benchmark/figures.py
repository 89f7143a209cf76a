"""Figures of a benchmark, as SVG text whose points carry their labels."""

import re
from collections.abc import Sequence
from html import escape

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from springpot.figures import STYLE, svg_text
from springpot.host.wings.evidence.benchmark.labels import hover
from springpot.host.wings.evidence.benchmark.point import Metadata, Point, points_of
from springpot.modelling import KINDS

Places = NDArray[np.float64]
Curves = dict[str, list[Metadata]]  # points of each family: name, time, error
_FRONT, _OFF = 8.5, 5.5  # size of marks, points
_PICK = 9.0  # of letters, points
# Of a label from its point: near, to the right, and then farther, around it.
_OFFSETS = np.array(
    [(24, y) for y in (30, -36, 50, -56, 80, -86, 120, 170)] + [(-60, 30), (-60, -36)]
)
_DASHES = ("-", "--", ":", "-.")


def front_figure(result: Metadata) -> str:
    """Every point, error on the validation recordings against time of a tick; front and picks."""
    points = points_of(result)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 5.6), layout="constrained")
        axes = figure.subplots()
        for i, point in enumerate(points):
            _mark(axes, point, f"point-{i}")
        _envelope(axes, points)
        _noise_floor(axes, result["quality"]["noise_floor_n"])
        _log_axes(axes, "time of a tick, hot, ns", "RMSE on the validation recordings, N")
        for kind in dict.fromkeys(point.model for point in points):
            shape, color = KINDS[kind].mark, KINDS[kind].colour
            axes.plot([], [], shape, color=color, ms=7, label=kind)
        axes.plot([], [], "o", color="white", mec="black", mew=1.6, ms=8, label="on the front")
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        figure.draw_without_rendering()  # or it is not known yet where on the page a point is
        _name_picks(axes, points, result["picks"])
        return _labelled(svg_text(figure), [hover(point) for point in points])


def family_figure(points: Sequence[Point]) -> str:
    """Whole models: the best error of each kind within each time, one line a kind."""
    with mpl.rc_context(STYLE):
        figure, axes = _small()
        for i, kind in enumerate(dict.fromkeys(point.model for point in points)):
            family = _best([point for point in points if point.model == kind])
            shape, color = KINDS[kind].mark, KINDS[kind].colour
            axes.plot(
                [point.tick_ns_hot for point in family], [point.rmse_n for point in family],
                marker=shape, color=color, ls=_DASHES[i % len(_DASHES)], lw=1.2, ms=6, label=kind,
            )  # fmt: skip
        _log_axes(axes, "time of a tick, hot, ns", "RMSE against measured force, N")
        axes.legend(frameon=False, fontsize=8)
        return svg_text(figure)


def curve_figure(curves: Curves, x: str, y: str) -> str:
    """One line a family, each point named."""
    with mpl.rc_context(STYLE):
        figure, axes = _small()
        draw_curves(axes, curves, x, y)
        return svg_text(figure)


def draw_curves(axes: Axes, curves: Curves, x: str, y: str) -> None:
    """The same into axes of a larger figure."""
    marks = [(kind.mark, kind.colour) for kind in KINDS.values()]
    for i, (family, curve) in enumerate(curves.items()):
        shape, color = marks[i]
        axes.plot([p["time"] for p in curve], [p["error"] for p in curve], marker=shape,
                  color=color, ls=_DASHES[i], ms=5, label=family)  # fmt: skip
        right = i % 2 == 0
        for point in curve:
            axes.annotate(
                point["name"], (point["time"], point["error"]), fontsize=7, color="#333333",
                xytext=(5, 4) if right else (-5, -9), textcoords="offset points",
                ha="left" if right else "right",
            )  # fmt: skip
    axes.margins(x=0.15)
    _log_axes(axes, x, y)
    axes.legend(frameon=False, fontsize=8)


def _small() -> tuple[Figure, Axes]:
    figure = Figure(figsize=(4.8, 3.8), layout="constrained")
    return figure, figure.subplots()


def _mark(axes: Axes, point: Point, gid: str) -> None:
    kind = KINDS[point.model]
    front = point.pareto
    axes.plot(
        [point.tick_ns_hot], [point.rmse_n], kind.mark, gid=gid, zorder=4 if front else 3,
        ms=_FRONT if front else _OFF, mfc=kind.colour if front else "none",
        mec="black" if front else kind.colour, mew=1.4 if front else 1.0,
    )  # fmt: skip


def _envelope(axes: Axes, points: Sequence[Point]) -> None:
    """The steps under which no point of the front lies."""
    best = _best([point for point in points if point.pareto])
    axes.step([point.tick_ns_hot for point in best], [point.rmse_n for point in best],
              where="post", color="black", lw=1.0, ls="--", zorder=2)  # fmt: skip


def _best(points: Sequence[Point]) -> list[Point]:
    """Points that are more accurate than all faster ones, fastest first."""
    found: list[Point] = []
    for point in sorted(points, key=lambda p: (p.tick_ns_hot, p.rmse_n)):
        if not found or point.rmse_n < found[-1].rmse_n:
            found.append(point)
    return found


def _noise_floor(axes: Axes, floor_n: float | None) -> None:
    if floor_n is None:
        return
    axes.axhline(floor_n, color="#555555", lw=0.8, ls=":")
    axes.annotate("noise of the recordings", (0.995, floor_n), ha="right", va="bottom",
                  xycoords=("axes fraction", "data"), fontsize=7.5, color="#555555")  # fmt: skip


def _name_picks(axes: Axes, points: Sequence[Point], picks: Metadata) -> None:
    """One label for each picked point, with the names of all budgets that pick it."""
    by_key = {point.key: point for point in points}
    names: dict[str, list[str]] = {}
    for name, found in picks.items():
        if found["point"]:
            names.setdefault(found["point"], []).append(name)
    marks = _on_page(axes, points)
    for key, budgets in names.items():
        text = "pick for " + ", ".join(budgets)
        at = _on_page(axes, [by_key[key]])
        places = [_inside(axes, at[0] + offset, text) for offset in _OFFSETS]
        place = min(places, key=lambda corner: int(_covered(corner, text, marks)))
        axes.annotate(
            text, (by_key[key].tick_ns_hot, by_key[key].rmse_n), xytext=place - at[0],
            textcoords="offset points", fontsize=_PICK, fontweight="bold",
            arrowprops={"arrowstyle": "-", "lw": 0.9}, zorder=6,
        )  # fmt: skip
        middle = place + np.array([0.5 * _width(text), 0.5 * _PICK])
        marks = np.concatenate([marks, np.repeat(middle[None], len(marks), axis=0)])


def _on_page(axes: Axes, points: Sequence[Point]) -> Places:
    """Where points are, in typographic points, (n, 2)."""
    values = np.array([(point.tick_ns_hot, point.rmse_n) for point in points])
    page: Places = axes.transData.transform(values) * (72.0 / axes.figure.dpi)
    return page


def _width(text: str) -> float:
    return 0.68 * _PICK * len(text)  # of bold letters


def _inside(axes: Axes, corner: Places, text: str) -> Places:
    """The lower left corner of a text, moved until the text is inside the axes."""
    box = np.reshape(axes.get_window_extent().extents, (2, 2)) * (72.0 / axes.figure.dpi)
    return np.clip(corner, box[0] + 4.0, box[1] - np.array([_width(text), 1.4 * _PICK]))


def _covered(corner: Places, text: str, marks: Places) -> int:
    """Marks, and labels before, that a text there would cover."""
    minimum, most = corner - 8.0, corner + np.array([_width(text) + 8.0, _PICK + 8.0])
    return int(np.sum(np.all((marks > minimum) & (marks < most), axis=1)))


def _log_axes(axes: Axes, x: str, y: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.4g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.grid(visible=True, which="major", color="#e4e4e4", lw=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def _labelled(svg: str, labels: Sequence[str]) -> str:
    """Give every marked group its label: a title, that browsers show on hover."""

    def titled(found: re.Match[str]) -> str:
        text = escape(labels[int(found[1])])
        return f'<g id="point-{found[1]}" class="point"><title>{text}</title>'

    return re.sub(r'<g id="point-(\d+)">', titled, svg)
