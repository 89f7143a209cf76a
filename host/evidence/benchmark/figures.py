"""Figures of a benchmark, as SVG text whose points carry their labels."""

import re
from collections.abc import Sequence
from html import escape

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from springpot.host.evidence.benchmark.labels import hover
from springpot.host.evidence.benchmark.point import Metadata, Point, points_of
from springpot.host.pages.plot_style import STYLE, svg_text
from springpot.trainer.kinds import KINDS

_FRONT, _OFF = 8.5, 5.5  # size of marks, points
_STRIP = 0.08  # of the error's decades, for the name of one pick
DASHES = ("-", "--", ":", "-.")


def front_figure(result: Metadata) -> str:
    """Draw every point, validation error against time of a tick; mark front and picks."""
    points = points_of(result)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 5.6), layout="constrained")
        axes = figure.subplots()
        for i, point in enumerate(points):
            _mark(axes, point, f"point-{i}")
        _envelope(axes, points)
        _noise_floor(axes, result["quality"]["noise_floor_n"])
        log_axes(axes, "time of a tick, hot, ns", "RMSE on the validation recordings, N")
        for kind in dict.fromkeys(point.model for point in points):
            shape, color = KINDS[kind].mark, KINDS[kind].colour
            axes.plot([], [], shape, color=color, ms=7, label=kind)
        axes.plot([], [], "o", color="white", mec="black", mew=1.6, ms=8, label="on the front")
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        _name_picks(axes, points, result["picks"])
        return _labelled(svg_text(figure), [hover(point) for point in points])


def family_figure(points: Sequence[Point]) -> str:
    """Return whole models: the best error of each kind within each time, one line a kind."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.8, 3.8), layout="constrained")
        axes = figure.subplots()
        for i, kind in enumerate(dict.fromkeys(point.model for point in points)):
            family = _best([point for point in points if point.model == kind])
            shape, color = KINDS[kind].mark, KINDS[kind].colour
            axes.plot(
                [point.tick_ns_hot for point in family], [point.rmse_n for point in family],
                marker=shape, color=color, ls=DASHES[i % len(DASHES)], lw=1.2, ms=6, label=kind,
            )  # fmt: skip
        log_axes(axes, "time of a tick, hot, ns", "RMSE against measured force, N")
        axes.legend(frameon=False, fontsize=8)
        return svg_text(figure)


def _mark(axes: Axes, point: Point, gid: str) -> None:
    kind = KINDS[point.model]
    front = point.pareto
    axes.plot(
        [point.tick_ns_hot], [point.rmse_n], kind.mark, gid=gid, zorder=4 if front else 3,
        ms=_FRONT if front else _OFF, mfc=kind.colour if front else "none",
        mec="black" if front else kind.colour, mew=1.4 if front else 1.0,
    )  # fmt: skip


def _envelope(axes: Axes, points: Sequence[Point]) -> None:
    """Draw the steps under which no point of the front lies."""
    best = _best([point for point in points if point.pareto])
    axes.step([point.tick_ns_hot for point in best], [point.rmse_n for point in best],
              where="post", color="black", lw=1.0, ls="--", zorder=2)  # fmt: skip


def _best(points: Sequence[Point]) -> list[Point]:
    """Return points that are more accurate than all faster ones, fastest first."""
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
    """Name each picked point with all budgets that pick it, in a strip below the lowest point."""
    by_key = {point.key: point for point in points}
    names: dict[str, list[str]] = {}
    for name, found in picks.items():
        if found["point"]:
            names.setdefault(found["point"], []).append(name)
    low_n, high_n = axes.get_ylim()
    axes.set_ylim(low_n * (low_n / high_n) ** (_STRIP * len(names)), high_n)
    # The slowest is lowest: its arrow leaves to the right, and crosses none of those above.
    for line, key in enumerate(sorted(names, key=lambda key: -by_key[key].tick_ns_hot)):
        axes.annotate(
            "pick for " + ", ".join(names[key]), (by_key[key].tick_ns_hot, by_key[key].rmse_n),
            xytext=(0.02, 0.02 + 0.06 * line), textcoords="axes fraction", fontsize=9.0,
            fontweight="bold", arrowprops={"arrowstyle": "-", "lw": 0.9, "relpos": (1.0, 0.5)},
            zorder=6,
        )  # fmt: skip


def log_axes(axes: Axes, x: str, y: str) -> None:
    """Make both axes logarithmic, with plain numbers at 1, 2 and 5, and label them."""
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
