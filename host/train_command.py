"""`springpot train`: fit one model."""

from pathlib import Path
from typing import Any

import click
import numpy as np

from springpot.codegen.ir import Model
from springpot.codegen.model_file import SUFFIX, write_model
from springpot.host.check_command import say_quality
from springpot.host.metrics import Accuracy, accuracy
from springpot.host.output import json_option, paths_argument, print_result, progress_console
from springpot.runtime_c.errors import UsageError
from springpot.trainer.recording import Recording
from springpot.trainer.recording_file import read_recordings


@click.command()
@paths_argument("recordings")
@click.option("--model", "kind", type=click.Choice(["rf-fd"]), required=True, help="Model kind.")
@click.option(
    "--validate",
    "validation",
    multiple=True,
    type=click.Path(),
    metavar="REC",
    help="Recording or folder to report the error on; may be repeated.",
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Model file to write.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option(
    "--fraction",
    type=click.FloatRange(0, 1, min_open=True),
    help="Share of rows used; default 0.2 from 20 000 rows on, all below.",
)
@click.option(
    "--window-s",
    type=click.FloatRange(0, min_open=True),
    help="Length of the filters' window, s; default 171 samples.",
)
@click.option(
    "--smooth-s",
    type=click.FloatRange(0),
    default=0.025,
    show_default=True,
    help="Zero-phase moving average of the training data, s; 0 for none.",
)
@click.option("--smooth-validation", is_flag=True, help="Smooth the validation data as well.")
@json_option
def train(
    recordings: tuple[str, ...],
    kind: str,
    validation: tuple[str, ...],
    out: Path,
    seed: int,
    fraction: float | None,
    window_s: float | None,
    smooth_s: float,
    smooth_validation: bool,
    as_json: bool,
) -> None:
    """Fit a model on RECORDINGS (files or folders)."""
    if out.suffix != SUFFIX:
        raise UsageError(f"--out {out}: model files end in {SUFFIX}: give a name like x{SUFFIX}")
    from springpot.trainer.rf_fd import RfFdOptions, fit_rf_fd  # scikit-learn, only where it fits

    options = RfFdOptions(seed=seed, fraction=fraction, window_s=window_s, smooth_s=smooth_s)
    training = read_recordings(map(Path, recordings))
    testing = read_recordings(map(Path, validation))
    say_quality(training)
    with progress_console.status(f"fitting {kind} on {len(training)} recordings"):
        fit = fit_rf_fd(out.stem.split(".")[0], training, options)
    out.parent.mkdir(parents=True, exist_ok=True)
    result: dict[str, Any] = {
        "model": kind,
        "out": str(out),
        "hash": write_model(out, fit.model),
        "seed": seed,
        "rows": fit.rows,
        "rows_total": fit.rows_total,
        "feature_s": fit.feature_s,
        "fit_s": fit.fit_s,
        "search_s": 0.0,
        "orders": list(fit.model.features.orders),
        "n_nodes": len(fit.model.regressor.feature),
        "importance": [float(share) for share in fit.importance],
        "window_s": len(fit.model.features.taps) * fit.model.dt_s,
        "engine": "fir",
    }
    rows = {
        "model": f"{kind}, {result['n_nodes']} nodes, {out}",
        "rows": f"{fit.rows} of {fit.rows_total}",
        "window": f"{result['window_s']:.4g} s",
        "time": f"features {fit.feature_s:.2f} s, fit {fit.fit_s:.2f} s",
        "hash": result["hash"],
    }
    if testing:
        found = _validated(fit.model, testing, smooth_s if smooth_validation else 0.0)
        result |= {
            "rmse_n": found.rmse_n,
            "rmse_percent_of_peak": found.rmse_percent_of_peak,
            "mean_recording_rmse_n": found.mean_recording_rmse_n,
        }
        rows["error"] = (
            f"RMSE {found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak, on "
            f"{len(testing)} validation recordings"
        )
    print_result(result, as_json, rows)


def _validated(model: Model, recordings: list[Recording], smooth_s: float) -> Accuracy:
    from springpot.trainer.predict import predict_n
    from springpot.trainer.smoothing import smoothed
    from springpot.trainer.training_set import common_time_step

    dt_s = common_time_step(recordings)
    if not np.isclose(dt_s, model.dt_s, rtol=1e-3):
        raise UsageError(
            f"--validate: recordings at {1 / dt_s:g} Hz, training at {1 / model.dt_s:g} Hz: "
            "import both with one --resample-hz"
        )
    prepared = [smoothed(recording, smooth_s) for recording in recordings]
    return accuracy(
        [recording.force_n for recording in prepared],
        [predict_n(model, recording) for recording in prepared],
    )
