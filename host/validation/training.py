"""What `springpot train` says of a fit, and the model's own error on other recordings."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from springpot.codegen.errors import UsageError
from springpot.codegen.model.model import Model
from springpot.host.metrics import Accuracy, accuracy
from springpot.host.validation.error_ratios import ratio_rows
from springpot.host.validation.seen import seen_line
from springpot.trainer.models.compatibility import require_compatible
from springpot.trainer.recordings.recording import Recording

if TYPE_CHECKING:
    from springpot.trainer.models.fit import Fit, FitOptions


def fit_options(options: Mapping[str, Any]) -> "FitOptions":
    """Fields of FitOptions, checked. Raises UsageError naming one that is not as it must be."""
    from springpot.trainer.models.fit import FitOptions

    known = [field.name for field in fields(FitOptions)]
    if unknown := options.keys() - set(known):
        raise UsageError(f"no option {min(unknown)!r}: known are {', '.join(known)}")
    try:
        return TypeAdapter(FitOptions).validate_python(options)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise UsageError(f"option {key}: {first['msg']} (found {first['input']!r})") from None


def training_result(fit: "Fit", options: "FitOptions") -> dict[str, Any]:
    """Keys of `train --json` that the fit knows."""
    model = fit.model
    return {
        "model": model.kind,
        "seed": options.seed,
        "rows": fit.rows,
        "rows_total": model.provenance["rows_total"],
        "feature_s": fit.feature_s,
        "fit_s": fit.fit_s,
        "search_s": fit.search_s,
        "orders": list(model.orders),
        "window_s": model.memory_s,
        "engine": model.engine,
        **fit.metadata,
    }


def training_rows(
    fit: "Fit", out: Path, result: dict[str, Any], found: Accuracy | None, tested: int
) -> dict[str, str]:
    """A person's view of a fit."""
    sizes = [f"{result[key]} {key[2:]}" for key in ("n_nodes", "n_centers", "n_parameters")
             if key in result]  # fmt: skip
    told = seen_line(result["seen"], tested) if found is not None else ""
    rows = {
        **({"training data": told} if told else {}),
        "model": f"{fit.model.kind}, {', '.join(sizes)}, {out}",
        "rows": f"{fit.rows} of {result['rows_total']}",
        "memory": f"{result['window_s']:.4g} s",
        "time": f"features {fit.feature_s:.2f} s, fit {fit.fit_s:.2f} s, "
        f"search {fit.search_s:.2f} s",
        "hash": result["hash"],
    }
    if "reduced" in result:
        asked, reduced = result["asked"], result["reduced"]
        rows["reduced"] = (
            f"{reduced['trees']} trees, {reduced['leaf']} in a leaf, {len(reduced['orders'])} "
            f"orders: {reduced['rmse_n']:.4g} N for {asked['rmse_n']:.4g} N, "
            f"{reduced['nodes']} nodes for {asked['nodes']}"
        )
    most_folds = max((score["folds"] for score in result.get("scores", ())), default=0)
    for score in result.get("scores", ()):
        mark = " <- chosen" if score["name"] == result["chosen"] else ""
        if score["folds"] < most_folds:
            mark = f": given up after {score['folds']} of {most_folds} folds"
        rows[f"  {score['name']}"] = (
            f"{score['mean_n']:.4g} N held out (recordings {score['recordings_n']:.4g}, "
            f"conditions {score['conditions_n']:.4g}){mark}"
        )
    if "why" in result:
        rows["  why"] = result["why"]
    for what, (value, width) in result.get("material", {}).items():
        why = result["not_identified"].get(what, "")
        rows[f"  {what}"] = (
            f"{value:.5g} +- {width:.2g}"
            if width is not None
            else (f"{value:.3g}: not identified, {why}")
        )
    if "residual_percent" in result:
        rows["  missed"] = f"{result['residual_percent']:.3g} % of the force that varies, rms"
    if found is not None:
        rows["error"] = (
            f"RMSE {found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak, on "
            f"{tested} validation recordings"
        )
        rows |= ratio_rows(result)
    return rows


def validated(model: Model, recordings: list[Recording], smooth_s: float) -> Accuracy:
    """Error of the model's own prediction. Raises DataError for recordings of another frame."""
    from springpot.trainer.models.predict import predict_n
    from springpot.trainer.recordings.smoothing import smoothed

    for recording in recordings:
        require_compatible(recording, model)
    prepared = [smoothed(recording, smooth_s) for recording in recordings]
    return accuracy(
        [recording.force_n for recording in prepared],
        [predict_n(model, recording) for recording in prepared],
    )
