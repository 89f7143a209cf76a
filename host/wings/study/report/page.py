"""The report of a study: opens the key, writes one page, tables, figures, and BIDS on request."""

import json
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from springpot import DataError, UsageError
from springpot.basics import write_file
from springpot.figures import page_text
from springpot.host.wings.study.folder import PARTICIPANTS, StudyFolder, read_folder
from springpot.host.wings.study.report.analysis import Analysis, analyse
from springpot.host.wings.study.report.bids import write_bids
from springpot.host.wings.study.report.choices import EVERYBODY
from springpot.host.wings.study.report.figures import psychometric_figure, rating_boxes
from springpot.host.wings.study.report.findings import (
    ALIKE,
    BOTH,
    DIFFERENT,
    OPEN,
    excluded_words,
    p_digits,
    percent,
    same_pair,
    summary,
    verdict,
)
from springpot.host.wings.study.report.loops import FeltLoops
from springpot.host.wings.study.report.tables import condition_rows, csv_text, write_tables
from springpot.host.wings.study.responses import read_responses

PAGE = "report.html"
_VERDICTS = {  # grade and words
    DIFFERENT: ("look", "different"),
    ALIKE: ("good", "alike"),
    BOTH: ("look", "different, within the margin"),
    OPEN: ("not-judged", "open"),
}


def write_study_report(
    study_folder: Path, out: Path | None = None, bids: Path | None = None
) -> dict[str, Any]:
    """Write the page and tables into `out`, by default the study's own folder `report`.

    Return the keys of `springpot study report --json`. Raises DataError where nobody has finished a
    trial, or the study is damaged."""
    folder = read_folder(study_folder)
    responses, replies = read_responses(folder)
    if not any(response.session > 0 for response in responses):
        raise DataError(
            f"{study_folder}: no finished trial yet: `springpot study run {study_folder} "
            "--participant 01`"
        )
    analysis = analyse(folder.study, responses, replies)
    place = study_folder / "report" if out is None else out
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{place}: {error.strerror}: give a folder for --out") from None
    tables = write_tables(analysis, responses, place)
    loops = FeltLoops(folder.study, analysis.responses)
    if loops.conditions:
        write_file(place / "loops.csv", csv_text(loops.rows()).encode())
        tables.append("loops.csv")
    text = page_text(
        "study_report.html", _context(folder, analysis, loops, tables),
        "springpot.host.wings.study", p=p_digits, percent=percent,
    )  # fmt: skip
    write_file(place / PAGE, text.encode())
    result: dict[str, Any] = {"out": str(place / PAGE), **analysis.as_dict(), "tables": tables}
    if bids is not None:
        participants = (folder.path / PARTICIPANTS).read_text(encoding="utf-8")
        files = write_bids(analysis, responses, participants, version("springpot"), bids)
        result["bids"] = {"out": str(bids), "files": len(files)}
    checked: dict[str, Any] = json.loads(json.dumps(result, allow_nan=False))
    return checked


def _context(
    folder: StudyFolder, analysis: Analysis, loops: FeltLoops, tables: list[str]
) -> dict[str, Any]:
    study, kept, whole = folder.study, analysis.kept_only, analysis.whole
    fits = [row for row in analysis.psychometric if row["participant"] == EVERYBODY]
    rated = study.method == "similarity"
    return {
        "study": study,
        "title": study.name,
        "simulated": folder.simulated,
        "summary": summary(analysis),
        "excluded": excluded_words(analysis),
        "people": analysis.people,
        "kept": kept,
        "whole": whole if analysis.excluded else None,
        "conditions": condition_rows(analysis),
        "verdicts": [] if kept is None else [_verdict(row, kept.equivalence) for row in kept.pairs],
        "boxes": rating_boxes(analysis) if rated else "",
        "boxes_words": _boxes_words(analysis) if rated else "",
        "loops": loops,
        "loops_figure": loops.figure() if loops.conditions else "",
        "loops_words": _loops_words(loops) if loops.conditions else "",
        "curves": psychometric_figure(analysis.curves) if analysis.curves else "",
        "fits": fits,
        "own_fits": [row for row in analysis.psychometric if row["participant"] != EVERYBODY],
        "sensitivity": [r for r in analysis.sensitivity if r["participant"] == EVERYBODY],
        "own_sensitivity": [r for r in analysis.sensitivity if r["participant"] != EVERYBODY],
        "questions": analysis.questions,
        "tables": tables,
        "hash": folder.hash,
        "key": folder.key.digest,
    }


def _verdict(pair: dict[str, Any], equivalence: list[dict[str, Any]]) -> dict[str, Any]:
    grade, words = _VERDICTS[verdict(pair, equivalence)]
    return {**pair, "grade": grade, "words": words, "equivalence": same_pair(pair, equivalence)}


def _boxes_words(analysis: Analysis) -> str:
    """Return what figure 18 shows beside the means that the summary names."""
    spans = [row["max"] - row["min"] for row in condition_rows(analysis)]
    if not spans:
        return ""
    return (
        "From the lowest to the highest person a condition spans "
        f"{float(np.median(spans)):.0f} points (median)."
    )


def _loops_words(loops: FeltLoops) -> str:
    rows = loops.rows()
    soft = min(rows, key=lambda row: float(row["stiffness_npm"]))
    hard = max(rows, key=lambda row: float(row["stiffness_npm"]))
    words = (
        f"Participant {loops.participant} pressed up to "
        f"{1e3 * max(row['deepest_m'] for row in rows):.1f} mm deep and felt up to "
        f"{max(row['hardest_n'] for row in rows):.1f} N. "
    )
    if soft is hard:
        return words
    return words + (
        f"Steepest is {hard['condition']} ({1e-3 * hard['stiffness_npm']:.2f} N/mm between the "
        f"greatest force and depth), flattest {soft['condition']} "
        f"({1e-3 * soft['stiffness_npm']:.2f} N/mm)."
    )
