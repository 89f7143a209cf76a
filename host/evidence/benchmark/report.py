"""The front page: which model for which budget, and why; from a benchmark's result."""

from collections.abc import Sequence
from pathlib import Path

from springpot.codegen.atomic_write import write_file
from springpot.host.evidence.benchmark import figures
from springpot.host.evidence.benchmark.labels import (
    flash_text,
    kilobytes,
    label,
    options_text,
)
from springpot.host.evidence.benchmark.point import Metadata, Point, Refused, points_of
from springpot.host.evidence.benchmark.store import RESULT, read_result
from springpot.host.evidence.paper.claims import PAPER_MODELLING_S, PAPER_RATES_HZ
from springpot.host.metrics import JND_WORDS, floor_words
from springpot.host.pages.page import page_text, plain
from springpot.host.simulation.objects import own_class_line
from springpot.trainer.kinds import KINDS

_REPORT_NAME = "report.html"


def bench_report(folder: Path) -> Path | None:
    """Write the page of a benchmark's folder, for `springpot report`; None if it is no such."""
    return write_bench_report(folder) if (folder / RESULT).exists() else None


def write_bench_report(folder: Path) -> Path:
    """Write folder/report.html. Raises DataError where the folder holds no benchmark."""
    path = folder / _REPORT_NAME
    write_file(path, bench_page(read_result(folder), folder.name).encode())
    return path


def bench_page(result: Metadata, folder: str) -> str:
    """Return the page: one text, nothing outside it."""
    points = points_of(result)
    by_key = {point.key: point for point in points}
    picks = [_pick(found, by_key) for found in result["picks"].values()]
    front = sorted((p for p in points if p.pareto), key=lambda p: p.tick_ns_hot)
    context = {
        "result": result,
        "folder": folder,
        "kinds": {name: kind.title for name, kind in KINDS.items()},
        "picks": picks,
        "summary": _summary(picks),
        "kin": own_class_line(item["source"] for item in result["recordings"]["training"]),
        "defaults": options_text(result["defaults"]),
        "front": front,
        "refused": [Refused(**facts) for facts in result["refused"]],
        "sizes_why": sorted({p.why for p in points if p.why}),
        "points": sorted(points, key=lambda p: p.rmse_n),
        "chart": figures.front_figure(result),
        "families": figures.family_figure(points),
        "verdicts": [
            (key, by_key[key], _cases(result["closed_loop"][key])) for key in _picked(picks)
        ],
        "paper": paper_rows(points),
        "quality": result["quality"],
        "floor_n": result["validation_floor"]["noise_floor_n"],
        "floor_words": floor_words(result["validation_floor"]),
        "jnd_words": JND_WORDS,
    }  # fmt: skip
    return page_text(
        "bench.html", context, "springpot.host.evidence",
        us=_microseconds, size=kilobytes, flash=flash_text, label=label,
    )  # fmt: skip


def paper_rows(points: Sequence[Point]) -> list[dict[str, str]]:
    """Return the paper's figures 9, 10 and Table 3 beside the same three models here.

    None if the sweep did not hold all three.
    """
    plain = {p.model: p for p in points if not p.options and p.model in PAPER_RATES_HZ}
    if len(plain) < len(PAPER_RATES_HZ):
        return []
    baseline = plain["rbf-pv"].mean_recording_rmse_n
    rows = []
    for kind, point in plain.items():
        own = point.mean_recording_rmse_n
        fits_s = point.feature_s + point.fit_s
        here_hz = 1e9 / point.tick_ns_hot
        rows.append(
            {
                "kind": kind,
                "rmse": f"{own:.3g} N",
                "rmse_paper": "baseline" if kind == "rbf-pv" else "slightly lower than rbf-pv",
                "rmse_ratio": f"{own / baseline:.2f} x rbf-pv",
                "fit": f"{fits_s:.2f} s",
                "fit_paper": f"{PAPER_MODELLING_S[kind]:g} s",
                "fit_ratio": f"{PAPER_MODELLING_S[kind] / fits_s:.0f} x faster",
                "rate": f"{here_hz / 1e3:.0f} kHz",
                "rate_paper": f"{PAPER_RATES_HZ[kind]:g} Hz",
                "rate_ratio": f"{here_hz / PAPER_RATES_HZ[kind]:.0f} x",
            }
        )
    return rows


def _pick(found: Metadata, by_key: dict[str, Point]) -> Metadata:
    return {**found, "point": by_key[found["point"]] if found["point"] else None}


def _picked(picks: list[Metadata]) -> list[str]:
    return list(dict.fromkeys(pick["point"].key for pick in picks if pick["point"]))


def _summary(picks: list[Metadata]) -> list[str]:
    """Answer what a reader asks first: which model for which budget, and is it safe to hold."""
    lines = []
    for key in _picked(picks):
        its = [pick for pick in picks if pick["point"] and pick["point"].key == key]
        titles = " and ".join(pick["budget"]["title"] for pick in its)
        line = f"{titles}: take {label(its[0]['point'])}"
        lines.append(
            line if its[0]["point"].bounded else f"{line}, for simulation only: no hand may hold it"
        )
    missing = [pick["budget"]["title"] for pick in picks if not pick["point"]]
    return [*lines, f"{', '.join(missing)}: no model"] if missing else lines


def _cases(outcomes: list[Metadata]) -> list[Metadata]:
    """Return the worst of all hands and delays, case by case."""
    rows = []
    for case in dict.fromkeys(outcome["case"] for outcome in outcomes):
        found = [outcome for outcome in outcomes if outcome["case"] == case]
        rows.append(
            {
                "case": case,
                "bounded": sum(outcome["bounded"] for outcome in found),
                "runs": len(found),
                "depth_mm": 1e3 * max(outcome["max_depth_m"] for outcome in found),
                "speed_mmps": 1e3 * max(outcome["hf_speed_mps"] for outcome in found),
                "fidelity_percent": max(outcome["fidelity_percent"] for outcome in found),
            }
        )
    return rows


def _microseconds(value_ns: float | None) -> str:
    return "–" if value_ns is None else plain(1e-3 * value_ns)
