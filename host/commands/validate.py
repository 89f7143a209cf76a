"""`springpot validate`: replay recordings through the C."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.codegen.messages import number_of
from springpot.host.options import PATH, recordings_given
from springpot.host.output import json_option, print_result, progress_bar

if TYPE_CHECKING:
    from springpot.host.validation.validation import Validation


@click.command(name="validate")
@click.argument("folder", type=PATH)
@recordings_given("Recording or folder")
@json_option
def validate_(folder: Path, recordings: tuple[str, ...], as_json: bool) -> None:
    """Replay recordings (files or folders) through the C of an emitted FOLDER."""
    from springpot.host.emission.emission import require_emission
    from springpot.host.validation.store import store_validation
    from springpot.host.validation.validation import fail_on_mismatch, validate
    from springpot.trainer.recordings.recording_file import read_recordings

    require_emission(folder)  # first: where both are given the wrong way round, it says so
    found = read_recordings(map(Path, recordings))
    with progress_bar(f"{number_of(len(found), 'recording')}"):
        validation = validate(folder, found)
    if len(validation.felt) < len(
        found
    ):  # a log says nothing of the object: the page keeps what does
        store_validation(folder, validation)
    print_result(validation.as_dict(), as_json, validation_rows(validation))
    fail_on_mismatch(folder, validation)


def _between_samples(validation: Validation) -> str:
    """What the C was given between the samples of recordings that are slower than the scene."""
    tick_s = validation.manifest["dt_s"]
    slower = [item for item in validation.recordings if item.dt_s > 1.001 * tick_s]
    if not slower:
        return ""
    return (
        f"; between those at {slower[0].rate_hz:g} Hz the C was given positions on a straight "
        f"line, at its {1.0 / tick_s:g} Hz"
    )


def _parts(validation: Validation) -> str:
    """The model's own error, and what coupling, guard and limits make of it.

    Neither is a part of the scene's error: the two may make up for each other.
    """
    alone_n, added_n = validation.model_rmse_n, validation.rendering_n
    if alone_n is None or added_n is None:
        return "not known"
    words = f"{alone_n:.4g} N; coupling, guard and limits change its force by {added_n:.4g} N (RMS)"
    if validation.felt:
        words += ", logs of sessions left out"
    coupling = validation.manifest.get("coupling", {})
    if added_n > alone_n and coupling.get("mode", "off") != "off":
        felt = 1e-3 * coupling["felt_stiffness_npm"]
        words += f": the hand feels {felt:.3g} N/mm through the coupling, see `springpot emit`"
    return words


def _deepest(validation: Validation) -> str:
    """How far ticks outside went: by noise above what the model was trained on, or another press.

    The trained depth is that of smoothed positions: a training press has such ticks too.
    """
    deepest_m = max(float(item.position_m.max()) for item in validation.recordings)
    trained_m = float(validation.manifest["trained"]["depth_m"][1])
    if not validation.notes.get("outside") or deepest_m <= trained_m:
        return ""
    return f"; deepest: {1e3 * deepest_m:.4g} of {1e3 * trained_m:.4g} mm"


def validation_rows(validation: Validation) -> dict[str, str]:
    """A person's view of a validation."""
    from springpot.host.metrics import error_ratios, ratio_rows, slope_keys, slope_words
    from springpot.host.session.outcome import notes_in_words
    from springpot.host.validation.compared import place_line
    from springpot.host.validation.seen import accepted_words, seen_line

    found, ticks, felt = validation.accuracy, validation.ticks, validation.felt
    told = seen_line(validation.seen, len(validation.predicted_n))
    interval = found.interval_n
    spread = f", 95 % in {interval[0]:.4g} .. {interval[1]:.4g}" if interval else ""
    below = found.ape_below_jnd
    rows = {
        "compared": f"{', '.join(felt)}: the calls of the session made again; the force sent is "
        "compared with that of the C, not with a measured object",
        "training data": told,
        "signs": accepted_words(validation.manifest),
        "edited C": ", ".join(validation.edited),
        "samples": str(found.samples)
        + (f", {found.ramped} of them in the start-up ramp: not counted" if found.ramped else "")
        + _between_samples(validation),
    }
    rows = {name: text for name, text in rows.items() if text and (felt or name != "compared")}
    differ = f"{validation.mismatches} ticks differ"
    by_place = place_line(validation.places)
    if len(felt) < len(validation.predicted_n):
        rows |= {
            "RMSE": f"{found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak",
            "RMSE, the model alone": _parts(validation),
            **ratio_rows(error_ratios(found, validation.floor)),
            "slope error": slope_words(slope_keys(validation.slopes)),
            **({"by place": by_place} if by_place else {}),
            "RMSE, mean of recordings": f"{found.mean_recording_rmse_n:.4g} N{spread}",
            "mean error": f"{found.mean_error_n:+.4g} N (the C less the measured force)",
            "maximum error": f"{found.max_abs_error_n:.4g} N; 99 %: {found.p99_abs_error_n:.4g} N",
            "below the JND above 2 N": "no such sample"
            if below is None
            else f"{100 * below:.1f} %",
        }
    else:
        felt_too = ", and so does what was felt"
        means = felt_too if validation.mismatches else ": what was felt is what the model says"
        differ = f"{validation.mismatches} of {found.samples} ticks differ{means}"
    told_notes = notes_in_words(validation.notes, validation.clamped_low, validation.min_n)
    return rows | {
        "C against reference": differ,
        "ticks with notes": told_notes + _deepest(validation),
        "tick, hot": f"{ticks.hot_median / 1e3:.3g} us",
        "tick, paced, cold": f"{ticks.p50 / 1e3:.3g} us, 99 % below {ticks.p99 / 1e3:.3g} us",
    }
