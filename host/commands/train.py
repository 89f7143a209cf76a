"""`springpot train`: fit one model."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot.codegen.errors import UsageError
from springpot.codegen.messages import number_of
from springpot.codegen.types import JsonObject
from springpot.host.console.options import NOT_NEGATIVE, PATH, POSITIVE, SEED, FiniteRange
from springpot.host.console.output import (
    json_option,
    paths_argument,
    print_result,
    progress_bar,
    say,
)
from springpot.trainer import PAPER_SMOOTH_S
from springpot.trainer.kinds import fit_model, kind_names

if TYPE_CHECKING:
    from springpot.trainer.models.fit import Fit


@click.command()
@paths_argument("recordings")
@click.option(
    "--model",
    "kind",
    type=click.Choice(kind_names()),
    default="auto",
    show_default=True,
    help="Model kind; auto: the one of lowest cross-validated error.",
)
@click.option(
    "--validate",
    "validation",
    multiple=True,
    type=click.Path(),
    metavar="REC",
    help="Recording or folder to report the error on; may be repeated.",
)
@click.option("--out", type=PATH, required=True, help="Model file to write.")
@click.option("--seed", type=SEED, default=0, show_default=True)
@click.option(
    "--fraction",
    type=FiniteRange(0, 1, min_open=True),
    help="Share of rows used; default 0.2 from 20 000 rows on, all below.",
)
@click.option(
    "--trees", type=click.IntRange(1), default=100, show_default=True, help="rf-fd: of the forest."
)
@click.option(
    "--leaf", type=click.IntRange(1), default=5, show_default=True,
    help="rf-fd: rows of the smallest leaf.",
)  # fmt: skip
@click.option(
    "--window-s",
    type=POSITIVE,
    help="Length of the filters' memory, s; default 171 samples, 1000 s if recursive.",
)
@click.option(
    "--smooth-s",
    type=NOT_NEGATIVE,
    default=PAPER_SMOOTH_S,
    show_default=True,
    help="Zero-phase moving average of the training data, s; 0 for none.",
)
@click.option("--smooth-validation", is_flag=True, help="Smooth the validation data as well.")
@click.option(
    "--engine",
    type=click.Choice(["fir", "fir-fast", "recursive"]),
    help="Fractional filters: the paper's taps, the same from a few exponentials, or exponentials "
    "that are exact at any rate; default fir, recursive where the window is long.",
)
@click.option(
    "--round-features",
    is_flag=True,
    help="rf-fd: trees on features in 16-bit steps; faster, no search.",
)
@click.option(
    "--past-positions", is_flag=True, help="rf-fd: on ten past positions, as its control."
)
@json_option
def train(
    recordings: tuple[str, ...],
    kind: str,
    validation: tuple[str, ...],
    out: Path,
    smooth_validation: bool,
    as_json: bool,
    **of_fit: Any,  # options of the same names as fields of FitOptions
) -> None:
    """Fit a model on RECORDINGS (files or folders)."""
    _require_model_file(out)  # before minutes of work
    from springpot.host.commands.fit_result import errors, training_result, training_rows
    from springpot.host.console.quality import report_quality
    from springpot.host.validation.seen import seen_line
    from springpot.trainer.models.fit import FitOptions  # scikit-learn, only where it fits
    from springpot.trainer.recordings.recording_file import given_recordings

    options = FitOptions(**of_fit)
    testing = given_recordings(validation)
    report = report_quality(recordings)
    training = report.checked
    with progress_bar(f"fitting {kind} on {number_of(len(training), 'recording')}"):
        fit = fit_model(kind, out.stem.split(".")[0], training, options, testing)
    for line in fit.warnings:
        say(f"warning: {line}")
    result = training_result(fit) | _written(fit, out)
    compared_s = options.smooth_s if smooth_validation else 0.0
    found, figures = errors(fit, training, testing, compared_s) if testing else (None, {})
    result |= figures
    if figures.get("seen"):
        say(seen_line(figures["seen"], len(testing)))
    print_result(result, as_json, training_rows(fit, result, out, found, len(testing)))


def _require_model_file(out: Path) -> None:
    from springpot.codegen.files import require_place
    from springpot.codegen.model.model_file import MODEL_SUFFIX

    if out.suffix != MODEL_SUFFIX:
        raise UsageError(
            f"--out {out}: model files end in {MODEL_SUFFIX}: give a name like x{MODEL_SUFFIX}"
        )
    require_place(out)


def _written(fit: "Fit", out: Path) -> JsonObject:
    from springpot.codegen.model.model_file import write_model

    out.parent.mkdir(parents=True, exist_ok=True)
    return {"out": str(out), "hash": write_model(out, fit.model)}
