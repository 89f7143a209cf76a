"""Judge each claim of paper.toml by what is measured."""

import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import paper_formulas as formulas
from paper_formulas import rms
from paper_results import COUPLED, KINDS, OBJECTS, ORDERS, OWN, PAST, SLOW_S, Result
from scipy.special import gamma

WORDS = tomllib.loads(Path(__file__).with_name("paper.toml").read_text("utf-8"))
PAIRS = dict(zip(OBJECTS, ((0.3, 0.35), (0.15, 0.2), *[(0.1, 0.15)] * 3), strict=True))  # table 2
Found = tuple[str, bool | None]  # what is found, and whether it meets the criterion; None: see why
Results = Sequence[Result]  # from the softest object to the hardest


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: its words and place, the criterion, the finding and the verdict."""

    section: str
    item: str
    paper: str
    criterion: str
    here: str
    verdict: str
    why: str = ""


def claims(results: Results) -> list[Claim]:
    """Every claim of the paper, in its order."""
    sections = (earlier_work, data, modelling, accuracy, cost, rendering, rates, loops, appendix)
    found = {key: value for section in sections for key, value in section(results).items()}
    return [judged(one, *found.get(f"{one['section']}, {one['item']}", ("", None)))
            for one in WORDS["claim"]]  # fmt: skip


def judged(stated: Mapping[str, str], here: str, holds: bool | None) -> Claim:
    """A claim with the verdict that paper.toml states, or with that of its criterion."""
    verdict = stated.get("verdict") or ("agrees" if holds else "differs")
    why = " ".join(filter(None, (stated.get("why"), stated.get("test"))))
    if holds is None and "verdict" not in stated:
        verdict, why = "not shown", "It is of other objects, or of several."
    return Claim(stated["section"], stated["item"], stated["paper"], stated.get("criterion", ""),
                 here, verdict, why)  # fmt: skip


def listed(values: Iterable[float]) -> str:
    """Three digits of each, and no minus before a zero."""
    return ", ".join(f"{round(float(value), 9) + 0.0:.3g}" for value in values)


def of_each(results: Results, value: Callable[[Result, str], float],
            kinds: Sequence[str] = KINDS) -> dict[str, list[float]]:  # fmt: skip
    """A value of every kind and object."""
    return {kind: [float(value(one, kind)) for one in results] for kind in kinds}


def by_kind(values: Mapping[str, Iterable[float]], unit: str = "") -> str:
    """The values of every kind, in words."""
    return "; ".join(f"{kind} {listed(each)}" for kind, each in values.items()) + unit


def ratios(results: Results, kind: str, other: str) -> list[float]:
    """RMSE of a fit over that of another, of every object."""
    return [one.rmse_n[kind] / one.rmse_n[other] for one in results]


def earlier_work(results: Results) -> dict[str, Found]:
    """Section II, and what section IV says of it."""
    errors = ratios(results, PAST, "rbf-pv")
    times = [one.modelling_s[PAST] / one.modelling_s["rbf-pv"] for one in results]
    past, ours = ([one.hands[kind] for one in results] for kind in (PAST, "rf-fd"))
    unsteady, taps_mj, cells = (
        [listed(getattr(one, name) for one in hands) for hands in (past, ours)]
        for name in ("unsteady", "taps_mj", "active_cells")
    )
    own = listed(one.own_active_cells for one in results)
    of = f"of {past[0].cases[0]}"
    return {
        "II, [24], accuracy": (listed(errors), max(errors) < 1.0),
        "II, [24], time": (listed(times), max(times) < 1.0),
        "II, negative damping": (f"{cells[0]} of 30", all(one.active_cells for one in past)),
        "II, energy": (f"{taps_mj[0]} mJ", all(one.taps_mj > 0.0 for one in past)),
        "II, unstable rendering": (f"{unsteady[0]} {of}", all(one.unsteady for one in past)),
        "IV, stable rendering": (f"{unsteady[1]} {of}; taps {taps_mj[1]} mJ, below 0: taken",
                                 not any(one.unsteady or one.taps_mj > 0.0 for one in ours)),
        "IV, negative damping": (f"rf-fd {cells[1]} of 30; {OWN} {own}",
                                 not any(one.active_cells for one in ours)),
    }  # fmt: skip


def data(results: Results) -> dict[str, Found]:
    """Section III, and the forest of section IV-B."""
    off = [10.0 * rms(one.press[1] - one.press[0]) for one in results]
    errors_n = of_each(results, lambda one, kind: one.rmse_n[kind], ("rf-fd", OWN))
    nodes = of_each(results, lambda one, kind: 1e-3 * one.nodes[kind], ("rf-fd", OWN))
    beyond, total_s = [100.0 * one.beyond for one in results], results[0].total_s
    return {
        "III-A, table 1, depths": (f"{listed(1e3 * one.depth_m for one in results)} mm", None),
        "III-B, length": (f"{total_s:.2f} s", round(total_s, 2) == 48.85),
        "III-B, figure 5": (f"{listed(off)} %", max(off) <= 5.0),
        "III-C, range": (f"{listed(beyond)} %", max(beyond) <= 1.0),
        "IV-B, equation 11, forest, figure 6": (
            f"RMSE {by_kind(errors_n)} N; thousands of nodes {by_kind(nodes)}", None),
    }  # fmt: skip


def modelling(results: Results) -> dict[str, Found]:
    """Section IV-B."""

    def chosen(how: str, kind: str) -> str:
        pairs = ", ".join("({:.2f}, {:.2f})".format(*one.pairs[how]) for one in results)
        return f"{pairs}, RMSE {listed(one.rmse_n[kind] for one in results)} N"

    off = np.array([np.subtract(one.pairs["paper"], PAIRS[one.name]) for one in results])
    by_cv = chosen("cv", "rbf-fd, by cross-validation")
    rows = {kind: ratios(results, kind, f"{kind}, all rows") for kind in KINDS}
    longer = of_each(results, lambda one, kind: (
        one.modelling_s[f"{kind}, all rows"] / one.modelling_s[kind]))  # fmt: skip
    slowest_s = max(one.modelling_s[f"{kind}, all rows"] for one in results for kind in KINDS[1:])
    small = of_each(results, lambda one, kind: one.small_ns[kind] / one.tick_ns(kind),
                    ("rf-fd", "rbf-pv"))  # fmt: skip
    return {
        "IV-B, table 2": (f"{chosen('paper', 'rbf-fd')}; by cross-validation {by_cv}",
                          bool(np.abs(off).max() < 0.051)),
        "IV-B, rows": (f"RMSE over that with all rows: {by_kind(rows)}", None),
        "IV-B, rows, time": (by_kind(longer, " times"), min(map(min, longer.values())) >= 2.0),
        "IV-B, all rows": (f"At most {slowest_s:.1f} s", slowest_s > 126.7),
        "IV-B, size": (by_kind(small, " times"), highest(small) < 1.0),
    }  # fmt: skip


def highest(values: Mapping[str, Iterable[float]]) -> float:
    """The highest value of all kinds and objects."""
    return max(map(max, values.values()))


def accuracy(results: Results) -> dict[str, Found]:
    """Section IV-C, figures 7 to 9."""
    missed = of_each(results, lambda one, kind: 10.0 * rms(one.shown_error_n(kind)))
    median = of_each(results, lambda one, kind: np.median(one.percent_off(kind)))
    noticed = of_each(results, lambda one, kind: 100.0 * np.mean(one.percent_off(kind) > 10.0))
    most = of_each(results, lambda one, kind: np.abs(one.shown_error_n(kind)).max())
    most_n = dict(zip((one.name for one in results), map(max, *most.values()), strict=True))
    softest_n = [most_n.pop(name) for name in OBJECTS[:1] if name in most_n]
    lower = {kind: ratios(results, kind, "rbf-pv") for kind in KINDS[:2]}
    same = ratios(results, "rf-fd", "rbf-fd")
    return {
        "IV-C, figure 7, match": (by_kind(missed, " % of 10 N"), highest(missed) <= 5.0),
        "IV-C, figure 7, errors": (f"{listed(most_n.values())} N" if most_n else "",
                                   max(most_n.values()) < 0.4 if most_n else None),
        "IV-C, figure 7, Ecoflex 00-10": (f"{listed(softest_n)} N" if softest_n else "",
                                          0.5 <= softest_n[0] <= 1.5 if softest_n else None),
        "IV-C, figure 8, JND": (by_kind(noticed, " % of the samples"), highest(noticed) == 0.0),
        "IV-C, figure 8, models": (by_kind(median, " %"), bool(np.all(
            np.array([median[kind] for kind in KINDS[:2]]) < median["rbf-pv"]))),
        "IV-C, figure 9, lower": (by_kind(lower), highest(lower) < 1.0),
        "IV-C, figure 9, slightly": (by_kind(lower), min(map(min, lower.values())) >= 0.8),
        "IV-C, figure 9, RF-FD, RBF-FD": (listed(same), min(same) >= 0.8 and max(same) <= 1.25),
    }  # fmt: skip


def cost(results: Results) -> dict[str, Found]:
    """Section IV-C, figures 10 and 11."""
    times = of_each(results, lambda one, kind: one.modelling_s[kind])
    mean = [float(np.mean(of_kind)) for of_kind in times.values()]
    tenfold = min(mean[1:]) >= 10.0 * mean[0]
    errors = {kind: ratios(results, "rf-fd", kind) for kind in KINDS[1:]}
    fewer = ratios(results, "important orders", "rf-fd")
    faster = [one.modelling_s["important orders"] / one.modelling_s["rf-fd"] for one in results]
    more = ratios(results, "orders to 1", "rf-fd")
    low = [float(one.importance[np.array(ORDERS) < 0.29].sum()) for one in results]
    medium, several = [1.0 - share for share in low], len(results) > 1
    return {
        "IV-C, figure 10, objects": (by_kind(times, " s"), alike(times, 1.5)),
        "IV-C, figure 10 (abstract, I, VI-C, VII)": (
            f"On average {listed(mean)} s ({', '.join(KINDS)})", tenfold),
        "IV-C, accuracy and cost": (
            f"RMSE of rf-fd over that of {by_kind(errors)}",
            tenfold and highest(errors) <= 1.25 and min(map(min, errors.values())) >= 0.8),
        "IV-C, fewer features": (f"RMSE {listed(fewer)} times; time {listed(faster)} times",
                                 max(fewer) < 1.0 and max(faster) < 1.0),
        "IV-C, figure 11, hard objects": (listed(low), low[-1] > 0.5 if several else None),
        "IV-C, figure 11, soft objects": (listed(medium), medium[0] > 0.5 if several else None),
        "IV-C, figure 11, high orders": (listed(more), min(more) > 0.9),
    }  # fmt: skip


def alike(values: Mapping[str, Sequence[float]], factor: float) -> bool | None:
    """Tell if objects differ by this factor at most, in every kind; None for a single object."""
    same = all(max(of_kind) <= factor * min(of_kind) for of_kind in values.values())
    return same if len(values["rf-fd"]) > 1 else None


def rendering(results: Results) -> dict[str, Found]:
    """Section V, the program, figures 12 and 13, algorithm 1."""
    differ = sum(one.validated[kind]["mismatches"] for one in results for kind in KINDS)
    stiffness = np.array([one.hands["rf-fd"].stiffness_npm for one in results])
    felt = formulas.SPRING_NPM * stiffness / (formulas.SPRING_NPM + stiffness)
    secant_npm = 10.0 / results[0].depth_m
    tool_m = np.minimum(np.arange(2000) / 1000, 1.0) * 5.0 / secant_npm
    places: tuple[Callable[[int, float, float], float], ...] = (
        lambda _, tool, proxy: secant_npm * tool, lambda _, tool, proxy: secant_npm * proxy
    )  # fmt: skip
    as_printed, meant = ([formulas.coupled_n(tool_m, place, sign)[-1] for place in places]
                         for sign in (1.0, -1.0))  # fmt: skip
    kinds = ("rf-fd", COUPLED)
    alone, coupled = ([one.hands[kind] for one in results] for kind in kinds)
    gains = [(a.unsteady - b.unsteady, a.active_cells - b.active_cells)
             for a, b in zip(alone, coupled, strict=True)]  # fmt: skip
    bad = by_kind(of_each(results, lambda one, kind: one.hands[kind].unsteady, kinds))
    cells = by_kind(of_each(results, lambda one, kind: one.hands[kind].active_cells, kinds))
    bends = [[rms(np.diff(force_n, 2)) for force_n in one.coupled_n] for one in results]
    printed = formulas.growth(1e3 * formulas.DAMPER_NSPM)
    return {
        "V, simulation of the models": (f"Other in {differ} ticks", differ == 0),
        "V, figure 12c": (
            f"The models have {listed(1e-3 * stiffness)} N/mm at depth; with their force computed "
            f"at the proxy, {listed(1e-3 * felt)} N/mm would be felt", None),
        "V, algorithm 1, sign": (
            f"Held at half the depth of {results[0].name}: {as_printed[0]:.3g} for {meant[0]:.3g} N"
            f" with f_M at the tool, {as_printed[1]:.3g} for {meant[1]:.3g} N at the proxy",
            all(abs(a / b - 1.0) < 0.01 for a, b in zip(as_printed, meant, strict=True))),
        "V, algorithm 1, parameters": (
            f"A stretch grows {printed:.0f} times a step. Stable below "
            f"{formulas.largest_damping_nspm():.4g} Ns/m", printed <= 1.0),
        "V, virtual coupling": (
            f"Unsteady, of {alone[0].cases[0]}: {bad}. Active cells, of 30: {cells}",
            all(min(each) >= 0 for each in gains) and any(max(each) > 0 for each in gains)),
        "V, figure 13": (listed(felt / own for own, felt in bends),
                         all(felt < own for own, felt in bends)),
    }  # fmt: skip


def rates(results: Results) -> dict[str, Found]:
    """Section V, table 3 and figure 14."""
    mhz = of_each(results, lambda one, kind: 1e3 / one.tick_ns(kind))
    forest, fd, pv = (float(np.mean(of_kind)) for of_kind in mhz.values())
    shown = f"{listed((forest, fd, pv))} MHz ({', '.join(KINDS)})"
    high = [max(np.array(ORDERS)[one.importance > 0.1]) for one in results]
    ticks_ms = [1e3 / 788.3, 1e3 / 990.3]
    change = 100.0 * max(formulas.change_of_step(order, SLOW_S) for order in ORDERS if order < 0.39)
    slow = [100.0 * rms(one.slow[1] - one.slow[2]) / rms(one.slow[2]) for one in results]
    return {
        "V, table 3, RF-FD": (shown, 0.7 <= forest / fd <= 0.9),
        "V, table 3, RBF-PV": (shown, pv / fd >= 1.5),
        "V, table 3, objects": (by_kind(mhz, " MHz"), alike(mhz, 1.5)),
        "V, update times": (f"{listed(ticks_ms)} ms", np.allclose(ticks_ms, (1.27, 1.01), 0, 5e-3)),
        "V, orders below 0.4": (f"Up to {listed(high)}", max(high) < 0.39),
        "V, errors at 1.27 ms": (f"At most {change:.2g} %", change < 10.0),
        "V, figure 14": (f"{listed(slow)} %", max(slow) < 5.0),
    }


def loops(results: Results) -> dict[str, Found]:
    """Section VI, figure 17 and the remedy for oscillations."""
    lost_mj = of_each(results, lambda one, kind: one.lost_mj(kind))
    slopes = of_each(results, lambda one, kind: 1e-3 * one.slope_npm(kind))
    hands = [one.hands["rf-fd"] for one in results]
    depths_mm = [1e3 * one.depth_m for one in results]
    ordered = all(np.all(np.diff(lost_mj[kind]) < 0.0) and np.all(np.diff(slopes[kind]) > 0.0)
                  for kind in KINDS)  # fmt: skip
    return {
        "VI-A, guideline": (f"{listed(depths_mm)} mm",
                            min(depths_mm) >= 7.45 and max(depths_mm) < 11.05),
        "VI-B, figure 17, loops": (by_kind(lost_mj, " mJ a signal"),
                                   min(map(min, lost_mj.values())) > 0.0),
        "VI-B, figure 17, hardness": (by_kind(slopes, " N/mm"),
                                      ordered if len(results) > 1 else None),
        "VI-C, remedy": (f"{listed(one.unbounded for one in hands)} of {hands[0].cases[1]}",
                         not any(one.unbounded for one in hands)),
    }  # fmt: skip


def appendix(results: Results) -> dict[str, Found]:
    """Appendix A."""
    slowest_us = 1e-3 * max(one.validated["rf-fd"]["tick_ns"]["p999"] for one in results)
    orders, last = np.linspace(0.0, 1.0, 21), max(k for k in range(1000) if gamma(k + 1.0) < np.inf)
    curves = [formulas.derivative(formulas.press(), order) for order in orders]
    to_f, to_rate = ([float(np.corrcoef(end, curve)[0, 1]) for curve in curves]
                     for end in (curves[0], curves[-1]))  # fmt: skip
    changes = [100.0 * max(formulas.change_of_step(order, step_s) for step_s in (0.8e-3, 1.2e-3))
               for order in orders]  # fmt: skip
    return {
        "A, overflow": (f"The last one that can has k = {last}", last < 172),
        "A, real time": (f"At most {slowest_us:.3g} us", slowest_us < 1e3),
        "A, figure 19": (
            f"At orders 0, 0.5, 1: {listed(to_f[::10])} with f; {listed(to_rate[::10])} with f'",
            bool(np.all(np.diff(to_f) < 0.0) and np.all(np.diff(to_rate) > 0.0))),
        "A, figure 20, low orders": (f"At most {max(changes[:11]):.2g} %", max(changes[:11]) < 10),
        "A, figure 20, high orders": (
            f"{changes[10]:.2g} % at order 0.5, {changes[-1]:.2g} % at 1",
            bool(np.all(np.diff(changes) > 0.0))),
    }  # fmt: skip
