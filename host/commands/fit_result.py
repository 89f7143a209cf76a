"""Result of `springpot train`: the fit, and the model's own error on other recordings."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from springpot.codegen.types import JsonObject
from springpot.host.metrics import Accuracy, accuracy, error_ratios, ratio_rows
from springpot.host.stiffness import slope_errors, slope_keys, slope_words
from springpot.host.validation.seen import seen_by, seen_line
from springpot.trainer.models.predict import require_compatible
from springpot.trainer.recordings.recording import Recording

if TYPE_CHECKING:
    from springpot.trainer.models.fit import Fit


def training_result(fit: "Fit") -> JsonObject:
    """Keys of `train --json` that the fit knows."""
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
    fit: "Fit",
    result: JsonObject,
    out: Path | None = None,
    found: Accuracy | None = None,
    tested: int = 0,
) -> dict[str, str]:
    """A person's view of a fit, of the keys of `training_result` and the model's hash.

    out: file of the model. found: error on `tested` recordings.
    """
    sizes = [f"{result[key]} {key[2:]}" for key in ("n_nodes", "n_centers", "n_parameters")
             if key in result]  # fmt: skip
    told = seen_line(result["seen"], tested) if found is not None else ""
    rows = {
        **({"training data": told} if told else {}),
        "model": ", ".join([fit.model.kind, *sizes, *([str(out)] if out else [])]),
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
    if "reduced" in result:
        asked, reduced = result["asked"], result["reduced"]
        rows["reduced"] = (
            f"{reduced['trees']} trees, {reduced['leaf']} in a leaf, {len(reduced['orders'])} "
            f"orders: {reduced['rmse_n']:.4g} N for {asked['rmse_n']:.4g} N, "
            f"{reduced['nodes']} nodes for {asked['nodes']}"
        )
    rows |= _score_rows(result)
    if "why" in result:
        rows["  why"] = result["why"]
    for what, (value, width) in result.get("material", {}).items():
        rows[f"  {what}"] = f"{value:.5g} +- {width:.2g}"
    if "residual_percent" in result:
        rows["  missed"] = f"{result['residual_percent']:.3g} % of the force that varies, rms"
    if found is not None:
        rows["error"] = (
            f"RMSE {found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak, on "
            f"{tested} validation recordings"
        )
        rows |= ratio_rows(result)
        rows["slope error"] = slope_words(result)
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
    """What the passive model does besides curves, branches and stops."""
    surface = "; a surface that recovers while the tool is away" if result["recovers"] else ""
    remembers = ""
    if result["starts_conditioned"]:
        remembers = "; a press begins as after the training presses"
    elif result["sessions"]:
        remembers = "; it remembers from one recording of a session to the next"
    return f"{result['law']}{surface}{remembers}"


def errors(
    fit: "Fit", training: Sequence[Recording], testing: Sequence[Recording], compared_s: float
) -> tuple[Accuracy, JsonObject]:
    """The error on `testing`, smoothed over compared_s, and the keys of `--json` on it.

    Of the model itself, without a pull at a surface, as its C has none.

    Raises DataError for recordings of another rate or zero.
    """
    from springpot.trainer.models.predict import limited_each_n
    from springpot.trainer.recordings.quality.repeats import find_noise_floor
    from springpot.trainer.recordings.signals import smoothed

    for recording in testing:
        require_compatible(recording, fit.model)
    known, new = ([smoothed(item, compared_s) for item in part] for part in (training, testing))
    # Those of one session come after the training ones, which the object remembers.
    predicted_n = limited_each_n(fit.model, [*known, *new])[len(known) :]
    found = accuracy([recording.force_n for recording in new], predicted_n)
    shown = ("rmse_n", "rmse_percent_of_peak", "mean_recording_rmse_n")
    return found, {
        "seen": seen_by(fit.model, testing),
        **{name: getattr(found, name) for name in shown},
        **error_ratios(found, find_noise_floor([*known, *new])),
        **slope_keys(slope_errors(new, predicted_n)),
    }
