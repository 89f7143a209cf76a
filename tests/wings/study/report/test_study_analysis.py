"""Results of people whose answers are known."""

from dataclasses import replace

import numpy as np
import pytest
from support.study_answers import choice_study, rating_study, ratings, replies, response

from springpot.host.wings.study.report.analysis import analyse
from springpot.host.wings.study.report.choices import EVERYBODY
from springpot.host.wings.study.report.findings import (
    ALIKE,
    DIFFERENT,
    OPEN,
    blind_words,
    excluded_words,
    summary,
    verdict,
)
from springpot.host.wings.study.statistics.psychometric import psychometric_share
from springpot.host.wings.study.statistics.sensitivity import sensitivity

STUDY = rating_study()
ANSWERS = ratings(STUDY, 14)
FOUND = analyse(STUDY, ANSWERS, replies(STUDY, 14))


def test_the_rules_leave_out_who_scatters_and_who_takes_sides() -> None:
    assert {one.participant: one.broken for one in FOUND.excluded} == {
        "13": ("repeat_sd_above",),
        "14": ("side_difference_above",),
    }
    by_name = {one.participant: one for one in FOUND.people}
    assert by_name["13"].repeat_sd == pytest.approx(np.std([5, 95, 20], ddof=1), rel=0.1)
    assert by_name["14"].side_difference == pytest.approx(60.0, abs=1.0)
    assert all(one.repeat_sd < 8 for one in FOUND.people[:12] if one.repeat_sd is not None)
    assert "13 (repeated answers scatter by more than 30), 14 (" in excluded_words(FOUND)
    free = analyse(replace(STUDY, exclude=type(STUDY.exclude)()), ANSWERS, [])
    assert free.excluded == []
    assert "no rule" in excluded_words(free)


def test_both_results_are_shown_with_everybody_and_without() -> None:
    assert len(FOUND.kept_only.people) == 12
    assert len(FOUND.whole.people) == 14
    result = FOUND.as_dict()
    assert [row["df2"] for row in result["anova"]] == [22, 11, 22]
    assert [row["df2"] for row in result["everybody"]["anova"]] == [26, 13, 26]
    assert result["trials"] == 14 * 3 * 11


def test_whether_leaving_people_out_matters_is_said() -> None:
    assert "With everybody, those left out too, " in " ".join(summary(FOUND))
    study = replace(STUDY, exclude=type(STUDY.exclude)())
    assert "those left out" not in " ".join(summary(analyse(study, ANSWERS, [])))


def test_pairs_are_compared_within_each_material_and_judged() -> None:
    found = FOUND.kept_only
    judged = {
        (row["within"], row["first"], row["second"]): verdict(row, found.equivalence)
        for row in found.pairs
    }
    assert judged == {
        ("soft", "RF", "RBF"): DIFFERENT, ("soft", "RF", "REAL"): DIFFERENT,
        ("soft", "RBF", "REAL"): ALIKE, ("hard", "RF", "RBF"): ALIKE,
        ("hard", "RF", "REAL"): ALIKE, ("hard", "RBF", "REAL"): ALIKE,
    }  # fmt: skip
    assert found.letters["soft"]["RF"] == "b"
    assert {found.letters["soft"][one] for one in ("RBF", "REAL")} == {"a"}


def test_a_large_p_is_open_and_never_likeness() -> None:
    study = rating_study(margin=None)
    found = analyse(study, ratings(study, 6, sd=25.0, differ=0.0)[: 4 * 33], [])
    kinds = {verdict(row, found.kept_only.equivalence) for row in found.kept_only.pairs}
    assert kinds == {OPEN}
    text = " ".join(summary(found))
    assert "which does not show that there is none" in text
    assert "studies like this find a difference of" in text
    assert found.kept_only.power["equivalence"] is None


def test_power_is_of_the_margin_and_the_scatter_seen() -> None:
    power = FOUND.as_dict()["power"]
    assert power["margin"] == 10.0
    assert power["sd"] == pytest.approx(5.0 * (2 / 3) ** 0.5, rel=0.2)
    assert power["difference"] > 0.99
    assert power["people_for_difference"] < 12


def test_half_a_study_is_reported_and_says_what_is_missing() -> None:
    early = analyse(STUDY, [r for r in ANSWERS if r.participant < "06" and r.pair != 2], [])
    assert early.kept_only.anova == []
    assert any("not yet asked in every condition" in note for note in early.kept_only.notes)
    one = analyse(STUDY, ANSWERS[:33], [])
    assert one.as_dict()["trials"] == 33
    assert any("needs at least" in note for note in one.whole.notes) if one.whole else False


def test_questions_are_counted_choices_that_nobody_took_too() -> None:
    rows = [row for row in FOUND.questions if row["question"] == "Vibrations?"]
    assert [(row["answer"], row["count"], row["of"]) for row in rows] == [
        ("yes", 9, 14), ("no", 5, 14),
    ]  # fmt: skip
    assert analyse(STUDY, ANSWERS, []).questions[0]["count"] == 0


def test_only_virtual_against_virtual_could_be_double_blind() -> None:
    assert "1 of 8 conditions could be double-blind, virtual against virtual (RF soft" in (
        blind_words(STUDY)
    )
    both = choice_study("constant", (1.1, 1.2, 1.3), 1)
    assert blind_words(both).startswith("Every condition could be double-blind")


def test_a_psychometric_function_of_known_people_is_found() -> None:
    levels = (1.0, 1.05, 1.1, 1.2, 1.3, 1.5)
    study, rng, answers = choice_study("constant", levels, 30), np.random.default_rng(3), []
    for person in range(4):
        for pair, level in enumerate(levels):
            for number in range(30):
                swapped = bool(number % 2)
                stiffer = rng.random() < psychometric_share(np.array(level), 1.15, 0.2, 0.0)
                slot = ("left" if swapped else "right") if stiffer else (
                    "right" if swapped else "left")  # fmt: skip
                one = study.pair[pair]
                shown = (one.right, one.left) if swapped else (one.left, one.right)
                answers.append(
                    response(f"{person:02d}", 1, number, pair, shown, swapped, slot, bool(stiffer))
                )
    found = analyse(study, answers, [])
    whole, *people = found.psychometric
    assert (whole["stimulus"], whole["participant"]) == ("stiffness", EVERYBODY)
    assert whole["low"] < 1.15 < whole["high"]
    assert whole["threshold"] == pytest.approx(1.15, abs=0.02)
    assert [row["participant"] for row in people] == ["00", "01", "02", "03"]
    assert found.as_dict()["anova"] == []
    # a comparison that equals the standard has no right answer, and no d'
    assert "standard | x1" not in {row["condition"] for row in found.sensitivity}
    # softer comparisons: the same people, seen from the other side
    softer = choice_study("constant", tuple(2.0 - level for level in levels), 30)
    names = {f"x{level:g}": f"x{2.0 - level:g}" for level in levels}
    turned = [
        replace(
            r,
            answer="left" if r.answer == "right" else "right",
            shown=tuple(names.get(name, name) for name in r.shown),
        )
        for r in answers
    ]
    mirrored = analyse(softer, turned, []).psychometric[0]
    assert mirrored["threshold"] == pytest.approx(2.0 - whole["threshold"], abs=1e-6)


def test_d_prime_counts_both_kinds_of_trials() -> None:
    study = choice_study("abx", (1.2,), 40)
    answers = []
    for number in range(40):
        x_is_a, right = number % 2 == 0, number % 5 != 0
        shown = ("standard", "x1.2", "standard" if x_is_a else "x1.2")
        told = "A" if x_is_a == right else "B"
        answers.append(response("01", 1, number + 1, 0, shown, False, told, right))
    (everybody, own) = analyse(study, answers, []).sensitivity
    expected = sensitivity("abx", 16, 20, 4, 20)
    assert (everybody["participant"], own["participant"]) == (EVERYBODY, "01")
    assert everybody["d_prime"] == own["d_prime"] == expected.d_prime
    assert everybody["correct"] == 0.8
