"""What a study found: who is left out, means, analysis of variance, Tukey's test."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas
from statsmodels.stats.anova import AnovaRM
from statsmodels.stats.multicomp import tukeyhsd

from springpot.codegen.arrays import Samples
from springpot.codegen.types import JsonObject
from springpot.host.study.definition import RENDERED, Study
from springpot.host.study.plan import Row, StudyPlan, read_table
from springpot.host.study.session import (
    ANSWER_COLUMNS,
    ANSWERS,
    RESPONSE_COLUMNS,
    RESPONSES,
    planned_trials,
)

_MIN_PEOPLE = 3
_NO_SCATTER = 1e-9  # of an error, points^2: what rounding leaves


def study_report(plan: StudyPlan) -> JsonObject:
    """Compute what `study report --json` prints. Raises DataError where a table is damaged.

    Participants with trials left, and those that a rule leaves out, are in no mean.
    """
    study, answers, of_each = plan.study, list[Row](), dict[str, list[Row]]()
    for person in plan.participants:
        rated = read_table(plan.folder(person) / RESPONSES, RESPONSE_COLUMNS)
        planned_trials(plan, person, rated)
        of_each[person] = [row for row in rated if row["session"] != "0"]
        answers += read_table(plan.folder(person) / ANSWERS, ANSWER_COLUMNS)
    whole = study.sessions * len(study.session_trials())
    finished = {person: answers for person, answers in of_each.items() if len(answers) == whole}
    judged = {person: consistency(study, answers) for person, answers in finished.items()}
    valid = [
        _ratings(answers) for person, answers in finished.items() if not judged[person]["broken"]
    ]
    keys = [(one.method, one.material) for one in study.conditions()]
    scores = np.array([[np.mean(answers[key]) for key in keys] for answers in valid])
    return {
        "trials": sum(map(len, of_each.values())),
        "people": len(valid),
        "unfinished": [person for person in of_each if person not in finished],
        "excluded": [{"participant": person, **figures} for person, figures in judged.items()
                     if figures["broken"]],
        "conditions": [
            {"method": key[0], "material": key[1], "mean": float(np.mean(column)),
             "se": float(np.std(column, ddof=1) / len(valid) ** 0.5) if len(valid) > 1 else None}
            for key, column in zip(keys, scores.T, strict=False)
        ],
        **_comparisons(study, scores),
        "questions": [
            {"question": question, "answer": answer, "count": number}
            for (question, answer), number in
            Counter((row["question"], row["answer"]) for row in answers).items()
        ],
    }  # fmt: skip


def consistency(study: Study, answers: Sequence[Row]) -> JsonObject:
    """Return a person's figures for the rules of exclusion, and the names of those broken.

    repeat_sd: standard deviation of the ratings of one condition, mean over conditions;
    side_difference: mean rating with the rendered object left less that with it right. None where
    there is nothing to compare.
    """
    spreads = [np.std(some, ddof=1) for some in _ratings(answers).values() if len(some) > 1]
    left, right = ([float(row["rating"]) for row in answers if row[side] == RENDERED]
                   for side in ("left", "right"))  # fmt: skip
    figures = {
        "repeat_sd": float(np.mean(spreads)) if spreads else None,
        "side_difference": float(np.mean(left) - np.mean(right)) if left and right else None,
    }
    limits = study.exclude_repeat_sd_above, study.exclude_side_difference_above
    broken = [name for (name, value), limit in zip(figures.items(), limits, strict=True)
              if value is not None and limit is not None and abs(value) > limit]  # fmt: skip
    return {**figures, "broken": broken}


def anova(scores: Samples, factors: Sequence[str]) -> list[JsonObject]:
    """Analyse the variance of repeated measures; p is not corrected for a lack of sphericity.

    scores: (people, levels of the first factor, ...). factors: names, one or two of them.
    Empty where people do not scatter.
    """
    table = [
        {"score": scores[place], "person": place[0], **dict(zip(factors, place[1:], strict=True))}
        for place in np.ndindex(scores.shape)
    ]
    if _error(scores.reshape(len(scores), -1)) < _NO_SCATTER:
        return []
    fit = AnovaRM(pandas.DataFrame(table), "score", "person", within=list(factors)).fit()
    return [{"effect": effect, "df1": int(df1), "df2": int(df2), "f": float(f), "p": float(p)}
            for effect, f, df1, df2, p in fit.anova_table.itertuples()]  # fmt: skip


def tukey(scores: Samples, conditions: Sequence[str]) -> list[JsonObject]:
    """Compare all pairs of conditions by Tukey's test on the error of repeated measures.

    scores: (people, conditions). difference: of the first's mean less the second's; low, high: its
    simultaneous 95 % interval.
    """
    people, k = scores.shape
    df = np.full(k, (people - 1) * (k - 1) / k)  # which it sums over the conditions
    pairs = tukeyhsd(scores.mean(axis=0), people, _error(scores), df=df)
    (first, second), differences, intervals, p_values = pairs[0], pairs[2], pairs[4], pairs[8]
    return [
        {"first": conditions[i], "second": conditions[j], "difference": -float(difference),
         "low": -float(high), "high": -float(low), "p_tukey": float(p)}
        for i, j, difference, (low, high), p in zip(
            first, second, differences, intervals, p_values, strict=True)
    ]  # fmt: skip


def _error(scores: Samples) -> float:
    """Return the mean square that person and condition, added up, leave of (people, k)."""
    people, k = scores.shape
    residual = scores - scores.mean(axis=0) - scores.mean(axis=1, keepdims=True) + scores.mean()
    return float(np.sum(residual**2) / ((people - 1) * (k - 1)))


def _comparisons(study: Study, scores: Samples) -> JsonObject:
    """Return the analysis over all materials; within each, that of methods and their pairs."""
    result: JsonObject = {"anova": [], "simple": [], "pairs": [], "notes": []}
    if len(scores) < _MIN_PEOPLE:
        result["notes"] = [f"{len(scores)} people: comparisons need at least {_MIN_PEOPLE}"]
        return result
    shape = len(scores), len(study.materials), len(study.methods)
    cells = scores[:, : shape[1] * shape[2]].reshape(shape)  # without the lower bound
    by_method = cells.transpose(0, 2, 1)
    if shape[1] > 1:
        result["anova"] = anova(by_method, ("Method", "Material"))
    for material, ratings in zip(study.materials, cells.transpose(1, 0, 2), strict=True):
        simple = anova(ratings, ("Method",))
        pairs = tukey(ratings, study.methods) if simple else []
        result["simple"] += [{"within": material, **row} for row in simple]
        result["pairs"] += [{"within": material, **row} for row in pairs]
    if len(result["simple"]) < shape[1] or (shape[1] > 1 and not result["anova"]):
        result["notes"] = ["ratings that differ alike for everybody cannot be tested"]
    return result


def _ratings(answers: Sequence[Row]) -> dict[tuple[str, str], list[float]]:
    """Return ratings by method and material."""
    ratings: dict[tuple[str, str], list[float]] = {}
    for row in answers:
        ratings.setdefault((row["method"], row["material"]), []).append(float(row["rating"]))
    return ratings
