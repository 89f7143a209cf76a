"""The page: the count, what is not the paper's, every claim, and the figures."""

import io
import sys
from collections import Counter
from collections.abc import Sequence
from html import escape

import numpy as np
from matplotlib.figure import Figure
from paper_claims import WORDS, Claim
from paper_formulas import Samples, change_of_step, derivative, press
from paper_results import KINDS, ORDERS, Result

import springpot

COLORS = dict(zip(KINDS, ("#d1495b", "#2e6f95", "#c98a00"), strict=True))
FIRST = COLORS["rf-fd"]
STYLE = """
body { font: 15px/1.4 sans-serif; margin: 2rem auto; max-width: 80rem; padding: 0 1rem }
table { border-collapse: collapse; width: 100% } figure { margin: 2rem 0 }
td, th { border: 1px solid #ccc; padding: .3rem; vertical-align: top; text-align: left }
svg { max-width: 100%; height: auto } .agrees { background: #efe } .differs { background: #fee }
"""
TITLES = {  # of the axes
    5: ("time, ms", "force, N; position, mm"), 7: ("time, s", "force, N"),
    8: ("force, N", "error, %"), 11: ("order", "importance"), 13: ("time, ms", "force, N"),
    14: ("time, s", "force, N"), 17: ("displacement, mm", "force, N"),
}  # fmt: skip
Line = tuple[str, Samples, Samples, str, str]  # label, x, y, color, style


def headline(found: Sequence[Claim]) -> str:
    """Count the claims that can come out either way."""
    count = Counter(claim.verdict for claim in found)
    return (f"{count['agrees']} of the {count['agrees'] + count['differs']} claims that are tested "
            f"agree, {count['differs']} differ. {count['not shown']} are not shown; "
            f"{count['by construction']} hold by construction and are not counted.")  # fmt: skip


def page(found: Sequence[Claim], results: Sequence[Result]) -> str:
    """One HTML file."""
    head = "".join(f"<th>{name}" for name in Claim.__dataclass_fields__)
    rows = "".join(f'<tr class="{one.verdict}">' + "".join(
        f"<td>{escape(cell)}" for cell in vars(one).values()) for one in found)  # fmt: skip
    drawn = {number: panels(number, results) for number in (5, 7, 8, 11, 13, 14, 17)}
    drawn |= {9: bars(results), 19: derivatives()}
    shown = "".join(framed(number, drawn[number]) for number in sorted(drawn))
    return f"""<!doctype html><html lang="en"><meta charset="utf-8">
<title>The paper, repeated</title><style>{STYLE}</style>
<h1>The paper's claims, repeated</h1><p><b>{escape(headline(found))}</b>
<p>Numbers are of {", ".join(one.name for one in results)}, in this order.
<h2>What is not the paper's</h2><p>{escape(WORDS["own"])}
<h2>Claims</h2><table><tr>{head}{rows}</table>
<h2>Figures</h2>{shown}<p>{escape(WORDS["left_out"])}
<p>springpot {springpot.__version__}, {sys.platform}</html>
"""


def lines(number: int, one: Result) -> list[Line]:
    """Lines of an object in a figure."""
    if number == 5:
        ms = np.arange(1000.0)
        command_n, force_n, position_m = one.press
        return [("command, N", ms, command_n, "k", "-"), ("force, N", ms, force_n, FIRST, "-"),
                ("position, mm", ms, 1e3 * position_m, "0.5", "--")]  # fmt: skip
    if number == 7:
        part = slice(one.shown.start, one.shown.start + 5000, 5)
        time_s = 1e-3 * np.arange(5000)[::5]
        forces_n = {"measured": one.measured_n, **one.predicted_n}
        return [
            *((f"{label}, N", time_s, force_n[part], COLORS.get(label, "k"), "-")
              for label, force_n in forces_n.items()),
            *(("", time_s, one.shown_error_n(kind)[:5000:5] - 3.0, COLORS[kind], "-")
              for kind in KINDS),
        ]  # fmt: skip
    if number == 8:
        return percentiles(one)
    if number == 13:
        ms, (model_n, felt_n) = np.arange(500.0), one.coupled_n
        return [("rf-fd alone, N", ms, model_n[3000:3500], "k", "-"),
                ("coupled and averaged, N", ms, felt_n[3000:3500], FIRST, "-")]  # fmt: skip
    if number == 14:
        time_s, slow_n, force_n = (values[:3000] for values in one.slow)
        return [("1 ms, N", time_s, force_n, "k", "-"), ("1.27 ms, N", time_s, slow_n, FIRST, "--")]
    part = slice(1000, 4000, 5)
    return [(f"{kind}, N", 1e3 * one.position_m[part], force_n[part], COLORS[kind], "-")
            for kind, force_n in one.predicted_n.items()]  # fmt: skip


def percentiles(one: Result) -> list[Line]:
    """Percentage errors in bins of the measured force, at least 0.25 N."""
    edges = np.arange(0.25, 10.01, 0.75)
    bins, jnd = np.digitize(one.measured_n, edges), np.array([[2.0, 10.0], [10.0, 10.0]])
    found = [("just noticeable: 10 %", jnd[0], jnd[1], "k", "--")]
    for kind in KINDS:
        off = 100.0 * np.abs(one.predicted_n[kind] / np.maximum(one.measured_n, 0.25) - 1.0)
        for share, style in ((50, "-"), (95, ":")):
            percent = [np.percentile(off[bins == k], share) if (bins == k).any() else np.nan
                       for k in range(1, len(edges))]  # fmt: skip
            label = f"{kind}, %, median" if share == 50 else ""
            found.append((label, edges[:-1] + 0.375, np.array(percent), COLORS[kind], style))
    return found


def panels(number: int, results: Sequence[Result]) -> Figure:
    """A figure with a panel for every object."""
    figure = Figure(figsize=(2.8 * len(results) + 1.0, 3.2), layout="constrained")
    for axes, one in zip(figure.subplots(1, len(results), squeeze=False)[0], results, strict=True):
        if number == 11:
            axes.bar(ORDERS, one.importance, 0.04, color=FIRST)
        for label, x, y, color, style in lines(number, one) if number != 11 else ():
            axes.plot(x, y, style, color=color, label=label, lw=0.9)
        axes.set_yscale("log" if number == 8 else "linear")
        axes.set_title(one.name, fontsize=9)
        axes.tick_params(labelsize=8)
        axes.set_xlabel(TITLES[number][0], fontsize=8)
    figure.axes[0].set_ylabel(TITLES[number][1], fontsize=8)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center",
                  ncols=2 * len(results), fontsize=8, frameon=False)  # fmt: skip
    return figure


def bars(results: Sequence[Result]) -> Figure:
    """Figures 9 and 10."""
    figure = Figure(figsize=(12, 3.2), layout="constrained")
    for axes, label, name in zip(figure.subplots(1, 2), ("RMSE, N", "modelling time, s"),
                                 ("rmse_n", "modelling_s"), strict=True):  # fmt: skip
        for shift, kind in enumerate(KINDS):
            heights = [getattr(one, name)[kind] for one in results]
            places = np.arange(len(results)) + 0.25 * (shift - 1)
            axes.bar(places, heights, 0.24, color=COLORS[kind], label=kind)
        axes.set_ylabel(label)
        axes.set_xticks(range(len(results)), [one.name for one in results], fontsize=8)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside right center", frameon=False)
    return figure


def derivatives() -> Figure:
    """Figures 19 and 20."""
    figure = Figure(figsize=(12, 3.2), layout="constrained")
    curves, changes = figure.subplots(1, 2)
    for order in (0.0, 0.25, 0.5, 0.75, 1.0):
        values = derivative(press(), order)
        curves.plot(values / np.abs(values).max(), label=f"order {order:g}")
    orders = np.linspace(0.0, 1.0, 21)
    for step_s in (0.8e-3, 1.2e-3, 1.27e-3):
        percent = [100.0 * change_of_step(order, step_s) for order in orders]
        changes.plot(orders, percent, label=f"{1e3 * step_s:g} ms")
    curves.set(xlabel="time, ms", ylabel="over the largest value")
    changes.set(xlabel="order", ylabel="RMS change, %")
    for axes in (curves, changes):
        axes.legend(frameon=False)
    return figure


def framed(number: int, figure: Figure) -> str:
    """A figure as SVG with its caption."""
    figure.savefig(file := io.StringIO(), format="svg", metadata={"Date": None})
    svg, name = file.getvalue(), {9: "s 9 and 10", 19: "s 19 and 20"}.get(number, f" {number}")
    caption = f"Figure{name}. {WORDS['captions'][str(number)]}"
    return f"<figure>{svg[svg.index('<svg') :]}<figcaption>{escape(caption)}</figcaption></figure>"
