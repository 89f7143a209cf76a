"""What a study shows, in sentences that are computed: what differs, what is alike, what is open.

A large p alone never becomes "no difference": beside it stands whether the conditions were shown to
be alike, and how often a study like this would have found what was looked for.
"""

from collections.abc import Sequence
from operator import itemgetter

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.outline import could_be_blind
from springpot.host.wings.study.report.analysis import Analysis
from springpot.host.wings.study.report.choices import EVERYBODY
from springpot.host.wings.study.report.comparisons import ALPHA, Comparisons, Row
from springpot.host.wings.study.report.scores import condition_title
from springpot.host.wings.study.report.tables import condition_rows

DIFFERENT, ALIKE, BOTH, OPEN = "different", "alike", "different, but alike", "open"


def p_words(p: float) -> str:
    """Return a p value as it is printed."""
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"


def p_digits(p: float) -> str:
    """Return a p value in a table."""
    return "< 0.0001" if p < 0.0001 else f"{p:.4f}"


def percent(share: float) -> str:
    """Return a share as it is printed; what is not certain is never 100 %."""
    return "over 99 %" if share > 0.99 else f"{100 * share:.0f} %"


def verdict(pair: Row, equivalence: Sequence[Row]) -> str:
    """Decide what is shown of a pair: a difference, likeness within the margin, both, neither."""
    differs, tested = pair["p_tukey"] < ALPHA, same_pair(pair, equivalence)
    alike = tested is not None and tested["equivalent"]
    return (BOTH if alike else DIFFERENT) if differs else ALIKE if alike else OPEN


def same_pair(pair: Row, rows: Sequence[Row]) -> Row | None:
    """Find the row of the same pair within the same level."""
    key = itemgetter("within", "first", "second")
    return next((row for row in rows if key(row) == key(pair)), None)


def summary(analysis: Analysis) -> list[str]:
    """Return what a reader should know first."""
    lines = [_people(analysis)]
    found = analysis.kept_only
    if found is not None:
        lines += [*_ratings(analysis), *_variance(found), *_left_out_matter(analysis)]
        lines += [*_pairs(found), *_power(found)]
        lines += _agreement(found)
    lines += [*_thresholds(analysis), *_sensitivity(analysis), blind_words(analysis.study)]
    return lines


def blind_words(study: Study) -> str:
    """Return which conditions nobody in the room could know."""
    blind = [k for k in range(len(study.pair)) if could_be_blind(study, k)]
    of = len(study.pair)
    if len(blind) == of:
        return (
            "Every condition could be double-blind: both stimuli are virtual, and codes hid them "
            "from the experimenter too."
        )
    single = (
        "in the others the experimenter placed a real object by its sticker, and could come to "
        "know it: these are single-blind"
    )
    if not blind:
        return f"No condition could be double-blind: {single.replace('in the others ', '')}."
    names = "; ".join(condition_title(study, k) for k in blind[:6])
    return (
        f"{len(blind)} of {of} conditions could be double-blind, virtual against virtual ({names}"
        f"{', and others' if len(blind) > 6 else ''}); {single}."
    )


def excluded_words(analysis: Analysis) -> str:
    """Return who is left out, and by which rule."""
    rules = analysis.study.exclude
    limits = {
        "repeat_sd_above": f"repeated answers scatter by more than {rules.repeat_sd_above or 0:g}",
        "side_difference_above": (
            f"answers with sides swapped differ by more than {rules.side_difference_above or 0:g}"
        ),
    }
    if analysis.study.method != "similarity":
        return "The rules of [exclude] are of ratings: nobody is left out here."
    if not any((rules.repeat_sd_above, rules.side_difference_above)):
        return "The study file has no rule for leaving people out: everybody counts."
    out = [
        f"{person.participant} ({'; '.join(limits[rule] for rule in person.broken)})"
        for person in analysis.excluded
    ]
    set_before = "by the rules that the study file set before the data"
    given = " and ".join(words for rule, words in limits.items() if getattr(rules, rule))
    if not out:
        return f"Nobody is left out {set_before} ({given})."
    return f"Left out {set_before}: {', '.join(out)}. Results with everybody stand below."


def _people(analysis: Analysis) -> str:
    people = {response.participant for response in analysis.responses}
    out = len(analysis.excluded)
    return (
        f"{len(people)} people did {len(analysis.responses)} trials that count"
        + (f"; {out} of them are left out by the rules set before" if out else "")
        + "."
    )


def _ratings(analysis: Analysis) -> list[str]:
    rows = sorted(condition_rows(analysis), key=lambda row: float(row["mean"]))
    if len(rows) < 2:
        return []
    low, high = rows[0], rows[-1]
    return [
        f"Ratings run from {low['mean']:.1f} ({low['condition']}) to {high['mean']:.1f} "
        f"({high['condition']}), of 0 to 100."
    ]


def _variance(found: Comparisons) -> list[str]:
    lines = []
    for row in found.anova:
        name = row["effect"].replace(":", " with ")
        df1, df2 = (row["eps_gg"] * row[key] for key in ("df1", "df2"))
        kind = "interaction of " if ":" in row["effect"] else ""
        seen = (
            "changes the ratings" if row["p_gg"] < ALPHA else "is not shown to change the ratings"
        )
        lines.append(
            f"The {kind}{name} {seen}: F({df1:.3g}, {df2:.3g}) = {row['f']:.2f}, "
            f"{p_words(row['p_gg'])} (Greenhouse-Geisser; uncorrected {p_words(row['p'])})."
        )
    return lines


def _left_out_matter(analysis: Analysis) -> list[str]:
    """Return whether leaving people out has changed what is shown."""
    kept, whole = analysis.kept_only, analysis.whole
    if not analysis.excluded or kept is None or whole is None or not (kept.anova and whole.anova):
        return []
    changed = [
        f"{row['effect'].replace(':', ' with ')} ({p_words(other['p_gg'])})"
        for row, other in zip(kept.anova, whole.anova, strict=True)
        if (row["p_gg"] < ALPHA) != (other["p_gg"] < ALPHA)
    ]
    if not changed:
        return ["With everybody, those left out too, the same factors change the ratings."]
    return [f"With everybody, those left out too, this turns round: {', '.join(changed)}."]


def _pairs(found: Comparisons) -> list[str]:
    if not found.pairs:
        return []
    verdicts = [verdict(row, found.equivalence) for row in found.pairs]
    different = [
        f"{row['first']} and {row['second']}" + (f" ({row['within']})" if row["within"] else "")
        for row, kind in zip(found.pairs, verdicts, strict=True)
        if kind in (DIFFERENT, BOTH)
    ]
    alike = sum(kind in (ALIKE, BOTH) for kind in verdicts)
    still_open = verdicts.count(OPEN)
    of = len(verdicts)
    named = ", ".join(different[:8]) + (", and others" if len(different) > 8 else "")
    lines = [f"{len(different)} of {of} pairs of conditions differ{': ' if named else ''}{named}."]
    if found.equivalence:
        margin = found.equivalence[0]["margin"]
        lines.append(
            f"{alike} of {of} pairs are shown to be alike within {margin:g}, each by itself, not "
            f"corrected for their number; {still_open} are open: neither a difference nor likeness "
            "is shown."
        )
    elif still_open:
        lines.append(
            f"{still_open} pairs are open: a difference is not shown, which does not show that "
            "there is none. The study file sets no margin, [equivalence], so likeness cannot be "
            "shown."
        )
    return lines


def _power(found: Comparisons) -> list[str]:
    power = found.power
    if power is None:
        return []
    lines = [
        f"With {power['people']} people, {100 * power['target']:.0f} % of studies like this find a "
        f"difference of {power['detectable']:.1f} between two conditions (d = "
        f"{power['detectable_d_z']:.2f}); a smaller one is missed more often."
    ]
    if power["margin"] is not None:
        lines.append(
            f"A true difference of the margin, {power['margin']:g}, would be found in "
            f"{percent(power['difference'])} of them, and true likeness shown in "
            f"{percent(power['equivalence'])}; for 80 %, {power['people_for_difference']} people "
            f"find that difference, and {power['people_for_equivalence']} show likeness."
        )
    return lines


def _agreement(found: Comparisons) -> list[str]:
    for row in found.agreement:
        if row["name"] == "icc_2_1":
            return [
                f"One session agrees with another by an intraclass correlation of "
                f"{row['value']:.2f} ({row['low']:.2f} to {row['high']:.2f}), over people and the "
                "conditions that are compared: 1 is the same ratings again, 0 is chance."
            ]
    return []


def _thresholds(analysis: Analysis) -> list[str]:
    lines = []
    for row in analysis.psychometric:
        if row["participant"] == EVERYBODY and row["threshold"] is not None:
            lines.append(
                f"{row['stimulus']}: at a level of {row['threshold']:.3g} (95 %: {row['low']:.3g} "
                f"to {row['high']:.3g}) everybody's answers are half-way from chance to certainty."
            )
    return lines


def _sensitivity(analysis: Analysis) -> list[str]:
    lines = []
    for row in analysis.sensitivity:
        if row["participant"] != EVERYBODY:
            continue
        high = "no bound" if row["high"] is None else f"{row['high']:.2f}"
        seen = "are distinguished" if row["low"] > 0.0 else "are not shown to be distinguished"
        lines.append(
            f"{row['condition']} {seen}: d' {row['d_prime']:.2f} (95 %: {row['low']:.2f} to "
            f"{high}), {100 * row['correct']:.0f} % right."
        )
    return lines
