"""Validation: recordings replayed through the C, against the measurement and the reference."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.coupling.loop_margin import LoopMargin
from springpot.codegen.errors import DataError, MismatchError
from springpot.codegen.files import parse_path
from springpot.codegen.messages import caution
from springpot.codegen.model.model import Model
from springpot.codegen.types import JsonObject
from springpot.host.emission.emission import Emitted, read_emission
from springpot.host.files import File, some_recordings
from springpot.host.metrics import (
    Accuracy,
    SlopeErrors,
    accuracy,
    error_ratio_keys,
    find_contacts,
    press_errors_n,
    slope_errors,
    slope_keys,
)
from springpot.host.native.replay import Replay, TickTimes
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.output import shown_fields
from springpot.host.stability.linear import margin_sentence, plan_margin
from springpot.host.validation.compared import (
    Compared,
    PlaceError,
    compare_all,
    is_session_log,
    place_errors,
    resample_to_samples,
    resample_to_ticks,
)
from springpot.host.validation.seen import count_training_recordings
from springpot.trainer.models import predict
from springpot.trainer.recordings.quality.repeats import NoiseFloor, find_noise_floor
from springpot.trainer.recordings.quality.signs import find_sign_refusals
from springpot.trainer.recordings.recording import Recording, axes_for_plot
from springpot.trainer.recordings.recording_file import Recordings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PACED_S = 3.0
GOOD_CONTACT = 0.95  # of the contact, with an error below the threshold of a hand
# Keys of `validate --json` that are attributes of the same name.
_NAMED = (
    "model_rmse_n",
    "rmse_by_start_n",
    "rendering_n",
    "mismatches",
    "notes",
    "clamped_low",
    "min_n",
    "seen",
)


@dataclass(frozen=True, eq=False)
class Validation(Compared):
    """Result over all `recordings`; predicted_n: forces of the C, one array a recording.

    floor: of the recordings, logs of sessions apart. presses_n: of `press_errors_n`. model_rmse_n:
    error of the model itself; rendering_n: RMS of the force that coupling, guard and limits add;
    None for logs alone, which neither counts. edited: files of the folder that are not as emitted.
    seen: how many recordings the model was trained on, None where it does not say. places: error of
    each, if recordings have any. min_n: the lower limit of the force, N, of `clamped_low`; other
    clamped ticks are at the upper limit. margin: gain margin of the scene's loop.

    >>> found = validate("c", recordings)
    >>> found.accuracy.rmse_n < 0.2
    True
    """

    accuracy: Accuracy
    ticks: TickTimes
    manifest: JsonObject
    floor: NoiseFloor
    recordings: tuple[Recording, ...]
    slopes: SlopeErrors | None
    presses_n: tuple[float, float] | None
    model_rmse_n: float | None
    rmse_by_start_n: dict[str, float | None]
    rendering_n: float | None
    edited: tuple[str, ...]
    seen: int | None
    places: tuple[PlaceError, ...]
    min_n: float
    margin: LoopMargin

    def __repr__(self) -> str:
        error = self.accuracy
        return (
            f"Validation(RMSE {error.rmse_n:.4g} N, {error.rmse_percent_of_peak:.3g} % of peak, "
            f"{len(self.predicted_n)} recordings, {self.mismatches} ticks differ)"
        )

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw measured force and that of the C, of the recording with the median RMSE.

        ax: matplotlib's axes, new ones if none are given. Return them. Raises UsageError where
        matplotlib is not installed.
        """
        axes = axes_for_plot(ax)
        pairs = list(zip(self.recordings, self.predicted_n, strict=True))
        draw_forces(axes, *median_error_recording(pairs))
        return axes

    @property
    def felt(self) -> list[str]:
        """Names of the recordings that are logs of sessions of this scene."""
        return [
            item.name for item in self.recordings if is_session_log(item, self.manifest["hash"])
        ]

    @property
    def verdict(self) -> str:
        """Judge the scene in a sentence that begins with a word.

        Good: stable, C and reference equal, and in 95 % of contact an error that no hand can tell,
        on recordings that the model was not trained on.
        """
        error, below = self.accuracy, self.accuracy.contact_below_jnd
        good = below is not None and below >= GOOD_CONTACT and not self.seen
        word = "Good" if good else "Look"
        parts = [f"error {error.rmse_percent_of_peak:.2g} % of peak ({error.rmse_n:.3g} N)"]
        if below is not None:
            parts.append(f"which a hand can feel in {100 * (1 - below):.3g} % of contact")
        if self.mismatches:
            parts.append(f"{self.mismatches} ticks differ from the reference")
        if self.mismatches or not self.margin.is_stable:
            word = "Do not hold"
        parts.append(f"{self.ticks.hot_median / 1e3:.2g} us a tick")
        return f"{word}: {', '.join(parts)}. {margin_sentence(self.margin)}"

    def as_dict(self) -> JsonObject:
        """Return keys of `validate --json`."""
        errors = asdict(self.accuracy)
        first_n, later_n = self.presses_n or (None, None)
        return {
            "verdict": self.verdict,
            "ramped_samples": errors.pop("ramped"),
            "mean_recording_rmse_interval_n": errors.pop("interval_n"),
            **errors,
            **error_ratio_keys(self.accuracy, self.floor),
            **slope_keys(self.slopes),
            "first_press_rmse_n": first_n,
            "later_press_rmse_n": later_n,
            **{name: getattr(self, name) for name in _NAMED},
            "tick_ns": shown_fields(self.ticks),
            "hash": self.manifest["hash"],
            "edited": list(self.edited),
            **({"places": [asdict(error) for error in self.places]} if self.places else {}),
        }


def validate(folder: File, recordings: Recordings, paced_s: float = PACED_S) -> Validation:
    """Replay recordings through the C of `folder`: its error, its time, its bits against numpy's.

    paced_s: how long ticks are timed at the scene's rate, s. Files that are not as
    emitted are a UserWarning; the result's `edited` names them. Raises DataError for recordings of
    another rate or zero than the model's.

    >>> validate("c", recordings).mismatches  # C and its reference: the same bits
    0
    """
    folder, recordings = parse_path(folder), some_recordings(recordings)
    emitted = read_emission(folder)
    plan, model = emitted.plan, _start_as_emitted(emitted)
    for recording in recordings:
        predict.require_compatible(recording, model, plan.dt_s)
        if plan.has_places and recording.place_m is None and not recording.channels:
            raise DataError(
                f"{recording.name}: has no place, and this scene has a map of them: give it on "
                "import, --place X,Y"
            )
    judged = [item for item in recordings if not is_session_log(item, emitted.hash)]
    beyond = (line for item in judged for line in predict.find_extrapolation(model, item))
    for doubt in (*find_sign_refusals(judged), *beyond, *predict.find_moving_starts(model, judged)):
        caution(doubt)
    library = SceneLibrary(folder)
    library.manifest["hash"] = emitted.hash  # of the C that was built, edits and all
    ticked = [resample_to_ticks(recording, plan.dt_s) for recording in recordings]
    compared = compare_all(plan, library, recordings, ticked)
    measured_n = [recording.force_n for recording in recordings]
    longest = max(ticked, key=lambda recording: len(recording.position_m))
    model_rmse_n, rendering_n, by_start_n = _parts(compared, emitted, recordings, ticked)
    errors_of = (recordings, compared.predicted_n, compared.ramped)
    return Validation(
        **vars(compared),
        accuracy=accuracy(
            measured_n,
            compared.predicted_n,
            compared.ramped,
            find_contacts(recordings, plan.contact),
        ),
        ticks=Replay(library).tick_times(longest.position_m, paced_s),
        manifest=library.manifest,
        floor=find_noise_floor(judged),
        recordings=tuple(recordings),
        slopes=slope_errors(*errors_of),
        presses_n=press_errors_n(*errors_of),
        model_rmse_n=model_rmse_n,
        rmse_by_start_n=by_start_n,
        rendering_n=rendering_n,
        edited=emitted.edited,
        seen=count_training_recordings(model, recordings),
        places=place_errors(*errors_of),
        min_n=float(plan.output.min_n),
        margin=plan_margin(plan),
    )


def _start_as_emitted(emitted: Emitted) -> Model:
    """Return the model that begins as the C does, which has no recording to look at."""
    start, model = emitted.plan.scene.runtime.start, emitted.model
    if start == "auto" and model.hammerstein is not None and not model.hammerstein.continues:
        start = "rested"
    return model.with_start(start)


def _parts(
    compared: Compared,
    emitted: Emitted,
    recordings: Sequence[Recording],
    ticked: Sequence[Recording],
) -> tuple[float | None, float | None, dict[str, float | None]]:
    """RMS of the model's own error, of the rendering's, and of its own by start, N; None: logs."""
    objects = [k for k, item in enumerate(recordings) if not is_session_log(item, emitted.hash)]
    dt_s = emitted.plan.dt_s
    if not any(len(recordings[k].force_n) > compared.ramped[k] for k in objects):
        return None, None, {}
    # Of a scene with a rate of its own, as exact.
    model = replace(_start_as_emitted(emitted), dt_s=dt_s)

    def rms_difference_n(started: Model, compared_n: Sequence[Samples]) -> float:
        """Return the RMS difference of a started model from forces, N."""
        alone_n = predict.predict_limited_n(started, [ticked[k] for k in objects])
        differences_n = [
            resample_to_samples(ticks_n, recordings[k], dt_s) - compared_n[k]
            for k, ticks_n in zip(objects, alone_n, strict=True)
        ]
        counted = zip(objects, differences_n, strict=True)
        return rms(np.concatenate([part_n[compared.ramped[k] :] for k, part_n in counted]))

    measured_n = [recording.force_n for recording in recordings]
    by_start_n = predict.compute_start_errors_n(
        model, lambda started: rms_difference_n(started, measured_n)
    )
    rendering_n = rms_difference_n(model, compared.predicted_n)
    return rms_difference_n(model, measured_n), rendering_n, by_start_n


def raise_on_mismatch(folder: Path, validation: Validation) -> None:
    """Raise MismatchError where C and reference differed in a tick."""
    if validation.mismatches:
        raise MismatchError(
            f"{folder}: C and its numpy reference differ in {validation.mismatches} of "
            f"{validation.accuracy.samples} ticks: check the compiler (CC, `springpot doctor`)"
        )


def draw_forces(axes: "Axes", recording: Recording, predicted_n: Samples) -> None:
    """Draw measured force and that of the C, (n,), N, against time."""
    time_s = recording.dt_s * np.arange(len(predicted_n))
    axes.plot(time_s, recording.force_n, color="black", lw=1.2, label="measured")
    axes.plot(time_s, predicted_n, color="tab:red", lw=1.0, ls="--", label="model (C)")
    axes.set(xlabel="time, s", ylabel="force, N")
    axes.set_title(recording.name, loc="left", fontsize=9)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, ncols=2)


def median_error_recording(pairs: Sequence[tuple[Recording, Samples]]) -> tuple[Recording, Samples]:
    """Return the recording that has the median RMSE, and the forces of the C along it."""
    errors_n = [rms(predicted_n - recording.force_n) for recording, predicted_n in pairs]
    return pairs[int(np.argsort(errors_n)[len(errors_n) // 2])]
