"""What a page says first of a scene: each finding with a grade, in words, and what to do."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from springpot import Stability
from springpot.checks import Grade, judge, judged_cases, may_do
from springpot.emission import Plan
from springpot.figures import plain
from springpot.host.wings.report.error_parts import SpeedError
from springpot.host.wings.report.relaxation import Hold, relaxed_share, settled_after_s
from springpot.validation import (
    SCORED_ABOVE_N,
    PlaceError,
    floor_words,
    geometric_mean,
    place_line,
)

_MOSTLY = 0.9  # of samples nearer than a hand can tell: good; below half: bad
_ACCURATE_PERCENT = 5.0  # RMSE, of the peak, where no sample is above the scored force
_SLID_PERCENT = 10.0  # of the peak, along the depth
_WORST_PLACE = 2.0  # times the mean of all places
_ONE_SIDED = 0.5  # mean error, of the RMSE
_SHORT_S = 1.0  # of memory: a soft object remembers longer
_UNRELAXED = 0.05  # of the force: what a hand may tell after a second


@dataclass(frozen=True)
class SceneFinding:
    """One line of the summary. todo: what mends it, empty where nothing must be."""

    name: str
    grade: Grade
    words: str
    todo: str = ""


def accuracy_findings(
    result: dict[str, Any], mean_error_n: float, speeds: Sequence[SpeedError]
) -> Iterator[SceneFinding]:
    """Error, its one-sided part, and where it is greatest. result: of `validate --json`."""
    rmse_n, share = result["rmse_n"], result["ape_below_jnd"]
    words = f"RMSE {plain(rmse_n)} N, {plain(result['rmse_percent_of_peak'], 2)} % of the peak"
    if share is None:
        good = result["rmse_percent_of_peak"] <= _ACCURATE_PERCENT
        grade = Grade.GOOD if good else Grade.LOOK
    else:
        grade = Grade.GOOD if share >= _MOSTLY else Grade.LOOK if share >= 0.5 else Grade.BAD
        words += (
            f"; {100 * share:.1f} % of samples above {SCORED_ABOVE_N:g} N differ by less "
            "than a hand can notice"
        )
    words += f"; {_ratio_words(result)}"
    worst = max(speeds, key=lambda item: item.rmse_n)
    words += f"; greatest at {_speeds(worst)} (RMSE {plain(worst.rmse_n)} N)"
    todo = "compare kinds with springpot bench, or record more of what the tool will do"
    rendered = result["rendering_n"] is not None and result["rendering_n"] > result["model_rmse_n"]
    if rendered:
        words += f"; the model alone misses {plain(result['model_rmse_n'])} N"
        todo = "coupling and limits add the rest, not the model: do what springpot emit warns of"
    yield SceneFinding("Accuracy", grade, words, todo if grade != Grade.GOOD else "")
    side = "more" if mean_error_n > 0 else "less"
    one_sided = abs(mean_error_n) > _ONE_SIDED * rmse_n
    yield SceneFinding(
        "Mean error",
        Grade.LOOK if one_sided else Grade.GOOD,
        f"{mean_error_n:+.3g} N: on average the C pushes {side} than the object"
        + (", which is most of its error" if one_sided else ""),
        ""
        if not one_sided
        else todo
        if rendered
        else "check the zero and the tare of the recordings (springpot check)",
    )


def by_place_findings(errors: Sequence[PlaceError]) -> Iterator[SceneFinding]:
    """Yield a finding that names the place where the C is off most; nothing for a single place."""
    if len(errors) < 2:
        return
    percents = [error.rmse_percent_of_peak for error in errors]
    worst = max(percents)
    apart = worst > _ACCURATE_PERCENT and worst > _WORST_PLACE * geometric_mean(percents)
    todo = "record sites nearer to each other there, as far apart as the smallest lump's radius"
    grade = Grade.LOOK if apart else Grade.GOOD
    yield SceneFinding("Places", grade, place_line(errors), todo if apart else "")


def relaxation_finding(plan: Plan, hold: Hold, recorded: Hold | None) -> SceneFinding:
    """Whether a held force falls as that of the object does."""
    lost, settled_s = relaxed_share(hold.force_n), settled_after_s(hold)
    sees_s = plan.model.memory_s
    windowed = settled_s <= sees_s < _SHORT_S
    grade = Grade.LOOK if windowed else Grade.GOOD
    todo = "to hold it, train hammerstein or with --engine recursive, on recordings with holds"
    if settled_s > 0.5 * hold.seconds:
        end = "and goes on"
    else:
        end = f"and does not relax beyond {plain(sees_s if windowed else settled_s, 2)} s"
    words = f"in a hold of {hold.seconds:.0f} s the force falls by {100 * lost:.1f} % {end}"
    if windowed:
        words += ", for the model sees no more of the past"
    if recorded is None or recorded.measured_n is None:
        words += "; no validation recording holds still for 1 s: what the object does is not known"
    else:
        measured, felt = relaxed_share(recorded.measured_n), relaxed_share(recorded.force_n)
        words += (
            f"; measured in {recorded.name}, held for {plain(recorded.seconds, 2)} s: the object "
            f"loses {100 * measured:.1f} %, the C {100 * felt:.1f} %"
        )
        if abs(measured - felt) > _UNRELAXED:
            grade = Grade.LOOK
    return SceneFinding("Relaxation", grade, words, "" if grade == Grade.GOOD else todo)


def stability_finding(found: Stability) -> SceneFinding:
    """The verdict, with the gravest case first."""
    worst = judged_cases(found.outcomes)[0]
    grade = worst.grade if worst.grade in (Grade.LOOK, Grade.BAD) else Grade.GOOD
    words = found.recommendation
    if not found.check.stable:
        return SceneFinding("Stability", Grade.BAD, words, "do not render it; see [coupling]")
    if grade == Grade.GOOD:
        return SceneFinding("Stability", grade, words)
    named = f"{worst.outcome.case} with the {worst.outcome.hand} hand: {worst.words}"
    faulty = [item.outcome for item in map(judge, found.outcomes) if item.grade == grade]
    todo = may_do(found.check.plan, faulty)
    return SceneFinding("Stability", grade, f"worst: {named}. {words}", todo)


def code_findings(result: dict[str, Any], manifest: dict[str, Any]) -> Iterator[SceneFinding]:
    """Bits, and what is not in the C."""
    differs = result["mismatches"]
    yield SceneFinding(
        "C and reference",
        Grade.BAD if differs else Grade.GOOD,
        f"{differs} of {result['samples']} ticks differ, bit for bit",
        "check the compiler (springpot doctor)" if differs else "",
    )
    accepted = manifest["provenance"].get("accepted_signs", [])
    if accepted:
        yield SceneFinding(
            "Signs",
            Grade.LOOK,
            f"the data of {', '.join(accepted)} speak against the signs that were accepted",
            "see that the force pushes out before a hand holds the device",
        )
    left_out = manifest["left_out"]
    named = ", ".join(item["what"] for item in left_out) or "nothing"
    yield SceneFinding("Left out of the C", Grade.GOOD, named)


def _ratio_words(ratios: dict[str, Any]) -> str:
    """Both ratios within a sentence."""
    per_floor, per_jnd = ratios["error_per_floor"], ratios["error_per_jnd"]
    floor = f"noise floor {floor_words(ratios)}"
    if per_floor is not None:
        floor = f"{plain(per_floor, 2)} times the noise floor"
    return f"{floor}, {plain(per_jnd, 2)} times the just noticeable difference"


def _speeds(found: SpeedError) -> str:
    low, high = plain(1e3 * found.low_mps, 2), plain(1e3 * found.high_mps, 2)
    return f"{low} to {high} mm/s"
