"""Tidy tables: every number of the page is a row of one of them."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from springpot.basics import write_file
from springpot.host.wings.study.outline import could_be_blind
from springpot.host.wings.study.report.analysis import Analysis
from springpot.host.wings.study.report.comparisons import Comparisons, Row
from springpot.host.wings.study.report.scores import by_condition, condition_title
from springpot.host.wings.study.responses import Response

_QUARTILES = ("min", "q1", "median", "q3", "max")


def write_tables(analysis: Analysis, responses: Sequence[Response], folder: Path) -> list[str]:
    """Write all that have a row; responses: practice too. Return the file names."""
    tables: dict[str, Sequence[Row]] = {
        "trials": trial_rows(analysis, responses),
        "people": [
            {**vars(person), "broken": " ".join(person.broken)} for person in analysis.people
        ],
        "conditions": condition_rows(analysis),
        "psychometric": analysis.psychometric,
        "psychometric_points": point_rows(analysis),
        "sensitivity": analysis.sensitivity,
        "questions": analysis.questions,
    }
    for name in ("anova", "simple", "pairs", "equivalence", "power", "agreement", "letters"):
        tables[name] = _of_both(analysis, name)
    written = []
    for name, rows in tables.items():
        if rows:
            write_file(folder / f"{name}.csv", csv_text(rows).encode())
            written.append(f"{name}.csv")
    return written


def csv_text(rows: Sequence[Mapping[str, Any]], delimiter: str = ",", missing: str = "") -> str:
    """Return a table with a header; what is not known is `missing`."""
    text = io.StringIO()
    names = list(dict.fromkeys(name for row in rows for name in row))
    writer = csv.writer(text, delimiter=delimiter, lineterminator="\n")
    writer.writerow(names)
    for row in rows:
        writer.writerow([_cell(row.get(name), missing) for name in names])
    return text.getvalue()


def trial_rows(analysis: Analysis, responses: Sequence[Response]) -> list[Row]:
    """Return a row a finished trial, in the order in which they were done; practice is session 0.

    counts: whether the results are made of it.
    """
    study = analysis.study
    left_out = {person.participant for person in analysis.excluded}
    factors = list(dict.fromkeys(name for pair in study.pair for name in pair.factors))
    rows = []
    for response in responses:
        pair = study.pair[response.pair]
        rows.append({
            "participant": response.participant,
            "session": response.session,
            "trial": response.number,
            "attempt": response.attempt,
            "condition": condition_title(study, response.pair),
            **{name: pair.factors.get(name) for name in factors},
            "left": pair.left,
            "right": pair.right,
            "shown": " | ".join(response.shown),
            "swapped": response.swapped,
            "level": study.stimulus_of(pair.right).at_level,
            "answer": response.answer,
            "correct": response.correct,
            "seconds": response.seconds,
            "presses": response.presses,
            "deepest_m": response.deepest_m,
            "fastest_mps": response.fastest_mps,
            "warnings": response.warnings,
            "excluded": response.participant in left_out,
            "counts": response.session > 0 and response.participant not in left_out,
            "log": response.log.name if response.log else None,
        })  # fmt: skip
    return rows


def condition_rows(analysis: Analysis) -> list[Row]:
    """Summarise people's means by condition, without those left out, as figure 18 draws them."""
    study = analysis.study
    if study.method != "similarity":
        return []
    rows = []
    for pair, people in by_condition(study, analysis.kept).items():
        means = np.array(list(people.values()))
        if len(means):
            quartiles = np.percentile(means, [0, 25, 50, 75, 100])
            rows.append({
                "condition": condition_title(study, pair),
                **study.pair[pair].factors,
                "left": study.pair[pair].left,
                "right": study.pair[pair].right,
                "could_be_double_blind": could_be_blind(study, pair),
                "people": len(means),
                "mean": float(means.mean()),
                "sd": float(means.std(ddof=1)) if len(means) > 1 else None,
                **dict(zip(_QUARTILES, map(float, quartiles), strict=True)),
            })  # fmt: skip
    return rows


def point_rows(analysis: Analysis) -> list[Row]:
    """Return answers at each level, and what the fit says there."""
    rows = []
    for curve in analysis.curves:
        fitted = curve.share(curve.levels) if curve.fit else [None] * len(curve.levels)
        rows += [
            {"stimulus": curve.series, "participant": curve.person, "level": float(level),
             "chosen": int(yes), "trials": int(n), "share": float(yes / n), "fitted": share}
            for level, yes, n, share in zip(
                curve.levels, curve.chosen, curve.trials, fitted, strict=True)
        ]  # fmt: skip
    return rows


def _of_both(analysis: Analysis, name: str) -> list[Row]:
    """Return rows of those left in, and, where somebody is left out, of everybody."""
    groups = {"kept": analysis.kept_only}
    if analysis.excluded:
        groups["everybody"] = analysis.whole
    return [
        {"people": group, **row}
        for group, found in groups.items()
        if found is not None
        for row in _rows(found, name)
    ]


def _rows(found: Comparisons, name: str) -> list[Row]:
    if name == "letters":
        return [
            {"within": within, "level": level, "letters": its}
            for within, letters in found.letters.items()
            for level, its in letters.items()
        ]
    if name == "power":
        return [] if found.power is None else [_renamed(found.power, "people", "n")]
    rows: list[Row] = getattr(found, name)
    return rows


def _renamed(row: Row, old: str, new: str) -> Row:
    return {new if name == old else name: value for name, value in row.items()}


def _cell(value: Any, missing: str) -> Any:
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return missing
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    return f"{value:.10g}" if isinstance(value, float) else value
