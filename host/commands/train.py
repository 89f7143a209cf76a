"""`springpot train`: fit one model, and say its own error on other recordings."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, get_args

import click

from springpot.codegen.errors import UsageError
from springpot.codegen.messages import counted_noun
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Start
from springpot.codegen.types import JsonObject
from springpot.host import steps
from springpot.host.metrics import (
    Accuracy,
    accuracy,
    error_ratio_keys,
    find_contacts,
    format_start_errors,
    ratio_rows,
    slope_errors,
    slope_keys,
    slope_sentence,
)
from springpot.host.options import (
    NOT_NEGATIVE,
    PATH,
    POSITIVE,
    SEED,
    FiniteRange,
    field_option,
    recordings_argument,
    recordings_option,
)
from springpot.host.output import json_option, print_line, print_result, progress_bar
from springpot.host.validation.rendered import Rendered, measure_rendered
from springpot.host.validation.seen import count_training_recordings, training_overlap_sentence
from springpot.trainer.kinds import fit_model, kind_names
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.predict import require_compatible
from springpot.trainer.recordings.recording import Recording

_SHARE = FiniteRange(0, 1, min_open=True)
_fit_option = partial(field_option, FitOptions, described=steps.train)


@click.command()
@recordings_argument
@click.option(
    "--model",
    "kind",
    type=click.Choice(kind_names()),
    default="auto",
    show_default=True,
    help="Model kind; auto: the one of lowest cross-validated error.",
)
@recordings_option("--validate", "validation", "Recording or folder to report the error on")
@click.option("--out", type=PATH, required=True, help="Model file to write.")
@_fit_option("seed", SEED)
@_fit_option("fraction", _SHARE)
@_fit_option("trees", click.IntRange(1))
@_fit_option("leaf", click.IntRange(1))
@_fit_option("tree_rows", _SHARE)
@_fit_option("split_features", _SHARE)
@_fit_option("window_s", POSITIVE)
@_fit_option("smooth_s", NOT_NEGATIVE)
@click.option(
    "--start",
    type=click.Choice(get_args(Start)),
    default="auto",
    show_default=True,
    help="How the validation recordings begin: with the object at rest, or as the training "
    "recordings left it; auto: as those begin.",
)
@click.option("--smooth-validation", is_flag=True, help="Smooth the validation data as well.")
@_fit_option("select", click.Choice(["cv", "paper"]))
@_fit_option("engine", click.Choice(["fir", "fir-fast", "recursive"]))
@_fit_option("round_features", None)
@_fit_option("past_positions", None)
@_fit_option("accept_misfit", None)
@json_option
def train(
    recordings: tuple[str, ...],
    kind: str,
    validation: tuple[str, ...],
    start: Start,
    out: Path,
    smooth_validation: bool,
    as_json: bool,
    **of_fit: Any,  # options of the same names as fields of FitOptions
) -> None:
    """Fit a model on RECORDINGS (files or folders)."""
    from springpot.codegen.files import require_writable
    from springpot.codegen.model.model_file import MODEL_SUFFIX, write_model
    from springpot.host.quality import report_quality
    from springpot.trainer.models.doubts import judge_misfit
    from springpot.trainer.recordings.recording_file import resolve_recordings

    if out.suffix != MODEL_SUFFIX:
        raise UsageError(
            f"--out {out}: model files end in {MODEL_SUFFIX}: give a name like x{MODEL_SUFFIX}"
        )
    require_writable(out)  # before minutes of work
    options = FitOptions(**of_fit)
    testing = resolve_recordings(validation)
    report = report_quality(recordings)
    training = report.checked
    with progress_bar(f"fitting {kind} on {counted_noun(len(training), 'recording')}"):
        fit = fit_model(kind, out.stem.split(".")[0], training, options, testing)
    for line in fit.warnings:
        print_line(f"warning: {line}")
    compared_s = fit.model.provenance["smooth_s"] if smooth_validation else 0.0
    error, figures = errors(fit, training, testing, compared_s, start) if testing else (None, {})
    share = 0.01 * (error.rmse_percent_of_peak or 0.0) if error else 0.0
    missed = "the validation recordings are missed"
    for line in judge_misfit(fit.model, share, missed, options.accept_misfit):
        print_line(f"warning: {line}")
    out.parent.mkdir(parents=True, exist_ok=True)
    result = training_result(fit) | {"out": str(out), "hash": write_model(out, fit.model)}
    result |= figures
    if figures.get("seen"):
        print_line(training_overlap_sentence(figures["seen"], len(testing)))
    print_result(result, as_json, training_rows(fit, result, error, len(testing)))


def training_result(fit: Fit) -> JsonObject:
    """Return keys of `train --json` that the fit knows."""
    model = fit.model
    return {
        "model": model.kind,
        "seed": model.provenance["seed"],
        "rows_total": model.provenance["rows_total"],
        **{name: getattr(fit, name) for name in ("rows", "feature_s", "fit_s", "search_s")},
        "orders": list(model.orders),
        "window_s": model.memory_s,
        "engine": model.engine,
        **fit.metadata,
    }


def training_rows(
    fit: Fit, result: JsonObject, error: Accuracy | None, tested: int
) -> dict[str, str]:
    """A person's view of a fit, of the keys of `--json`; found: error on `tested` recordings."""
    sizes = [f"{result[key]} {key[2:]}" for key in ("n_nodes", "n_centers", "n_parameters")
             if key in result]  # fmt: skip
    seen = training_overlap_sentence(result["seen"], tested) if error is not None else ""
    rows = {
        **({"training data": seen} if seen else {}),
        "model": ", ".join([fit.model.kind, *sizes, result["out"]]),
        "rows": f"{fit.rows} of {result['rows_total']}",
        "memory": f"{result['window_s']:.4g} s",
        "time": f"features {fit.feature_s:.2f} s, fit {fit.fit_s:.2f} s, "
        f"search {fit.search_s:.2f} s",
        "hash": result["hash"],
    }
    if "law" in result:
        rows["law"] = _law(result)
    if "places" in result:
        mixed = {1: "one material"}.get(result["materials"], f"{result['materials']} materials")
        rows["map"] = (
            f"{result['places']} places, {mixed}: {result['cv_rmse_n']:.3g} N where a fifth of the "
            "places is left out"
        )
    rows["residual"] = f"{result['residual_n']:.3g} N rms; {result['residual_where']}"
    rows |= _score_rows(result)
    if "why" in result:
        rows["  why"] = result["why"]
    for what, (value, width) in result.get("material", {}).items():
        doubt = "without interval: not its law" if width is None else f"+- {width:.2g}"
        at_rest = ", extrapolated to rest" * (what == "stiffness_npm")
        rows[f"  {what}"] = f"{value:.5g} {doubt}{at_rest}"
    if "residual_percent" in result:
        rows["  missed"] = f"{result['residual_percent']:.3g} % of the force that varies, rms"
    if error is not None:
        rows["error"] = (
            f"RMSE {error.rmse_n:.4g} N, {error.rmse_percent_of_peak:.3g} % of peak, on "
            f"{tested} validation recordings"
        )
        if by_start := format_start_errors(result["rmse_by_start_n"]):
            rows["  by start"] = by_start
        if (percent := result["rendered_rmse_percent_of_peak"]) is not None:
            rows["  as emitted"] = (
                f"RMSE {result['rendered_rmse_n']:.4g} N, {percent:.3g} % of peak, behind coupling "
                f'"{result["rendered_coupling"]}"'
            )
        rows |= ratio_rows(result)
        rows["slope error"] = slope_sentence(result)
    return rows


def _score_rows(result: JsonObject) -> dict[str, str]:
    """Held-out errors of the candidates of `auto`."""
    rows = {}
    scores = result.get("scores", ())
    most_folds = max((score["folds"] for score in scores), default=0)
    for score in scores:
        mark = " <- chosen" if score["name"] == result["chosen"] else ""
        if score["folds"] < most_folds:
            mark = f": given up after {score['folds']} of {most_folds} folds"
        rows[f"  {score['name']}"] = (
            f"{score['mean_n']:.4g} N held out (recordings {score['recordings_n']:.4g}, "
            f"conditions {score['conditions_n']:.4g}){mark}"
        )
    return rows


def _law(result: JsonObject) -> str:
    """List the laws of the passive model beside its curves, branches and stops, and its start.

    As in "flow, damage; a surface that recovers while the tool is away".
    """
    surface = "; a surface that recovers while the tool is away" if result["recovers"] else ""
    remembers = ""
    if result["starts_conditioned"]:
        remembers = "; a press begins as after the training presses"
    elif result["sessions"]:
        remembers = "; it remembers from one recording of a session to the next"
    return f"{result['law']}{surface}{remembers}"


def errors(
    fit: Fit,
    training: Sequence[Recording],
    testing: Sequence[Recording],
    compared_s: float,
    start: Start = "auto",
) -> tuple[Accuracy, JsonObject]:
    """Return the error on `testing`, smoothed over compared_s, and the keys of `--json` on it.

    Of the model itself, without a pull at a surface, as its C has none.

    Raises DataError for recordings of another rate or zero.
    """
    from springpot.trainer.models.predict import (
        compute_start_errors_n,
        find_moving_starts,
        predict_limited_n,
    )
    from springpot.trainer.recordings.quality.repeats import find_noise_floor
    from springpot.trainer.recordings.signals import smooth

    for recording in testing:
        require_compatible(recording, fit.model)
    known, new = ([smooth(item, compared_s) for item in part] for part in (training, testing))
    # Those of one session come after the training ones, which the object remembers.
    model = fit.model.with_start(start)
    predicted_n = predict_limited_n(model, [*known, *new])[len(known) :]
    measured_n = [recording.force_n for recording in new]
    contacts = find_contacts(new, fit.model.contact == "surface")
    error = accuracy(measured_n, predicted_n, contacts=contacts)
    rendered = measure_rendered(fit.model, new, known)
    for line in find_moving_starts(model, new):
        print_line(f"warning: {line}")

    def rmse_n(started: Model) -> float:
        return accuracy(measured_n, predict_limited_n(started, new)).rmse_n

    shown = ("rmse_n", "rmse_percent_of_peak", "mean_recording_rmse_n")
    return error, {
        "seen": count_training_recordings(fit.model, testing),
        "start": start,
        "rmse_by_start_n": compute_start_errors_n(fit.model, rmse_n),
        **{name: getattr(error, name) for name in shown},
        **error_ratio_keys(error, find_noise_floor([*known, *new])),
        **slope_keys(slope_errors(new, predicted_n)),
        **rendered_keys(rendered),
    }


def rendered_keys(rendered: Rendered | None) -> JsonObject:
    """Return keys of `--json` on what `emit` would render; null without a compiler."""
    return {
        "rendered_rmse_n": rendered and rendered.accuracy.rmse_n,
        "rendered_rmse_percent_of_peak": rendered and rendered.accuracy.rmse_percent_of_peak,
        "rendered_coupling": rendered and rendered.coupling.coupling.mode,
    }
