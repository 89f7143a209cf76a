"""Validation: recordings replayed through the C, against the measurement and the reference."""

import json
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.entry_points import required_part
from springpot.codegen.errors import DataError, MismatchError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import member_offset
from springpot.codegen.progress import counted
from springpot.codegen.reference.run import run_reference
from springpot.host.console.output import shown_fields
from springpot.host.emission.emission import read_emission
from springpot.host.metrics import Accuracy, accuracy, error_ratios, rms, start_up_ramp
from springpot.host.native.loop_library import LATERAL, NONE, SILENT, UNSENT
from springpot.host.native.replay import Replay, TickTimes, motions_of
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session.note_words import NOTE_NAMES
from springpot.host.stiffness import SlopeErrors, slope_errors, slope_keys
from springpot.host.validation.by_place import PlaceError, place_errors
from springpot.host.validation.seen import seen_by
from springpot.host.validation.ticks import at_samples, at_ticks, samples_of
from springpot.trainer.faces import Faces
from springpot.trainer.models.compatibility import require_compatible
from springpot.trainer.models.limited import limited_each_n
from springpot.trainer.recordings.notices import caution
from springpot.trainer.recordings.quality.noise_floor import NoiseFloor, find_noise_floor
from springpot.trainer.recordings.quality.signs import sign_doubts
from springpot.trainer.recordings.recording import Recording

PACED_S = 3.0


@dataclass(frozen=True, eq=False)
class Validation(Faces):
    """Result over all `recordings`; predicted_n: forces of the C, one array a recording.

    mismatches: ticks where C and reference, or a board and the C, differ in force or notes, bit for
    bit. floor: of the recordings, logs of sessions apart. model_rmse_n: error of the model itself;
    rendering_n: RMS of what coupling, guard and limits add to it; None for logs alone. edited:
    files of the folder that are not as emitted, and were accepted. seen: how many recordings the
    model was trained on, None where it does not say. places: error of each, if recordings have any.

    >>> found = validate("c", recordings)
    >>> found.accuracy.rmse_n < 0.2
    True
    """

    accuracy: Accuracy
    mismatches: int
    notes: dict[str, int]
    ticks: TickTimes
    predicted_n: tuple[NDArray[np.float64], ...]
    manifest: dict[str, Any]
    floor: NoiseFloor
    recordings: tuple[Recording, ...]
    slopes: SlopeErrors | None = None
    model_rmse_n: float | None = None
    rendering_n: float | None = None
    edited: tuple[str, ...] = ()
    seen: int | None = None
    places: tuple[PlaceError, ...] = ()

    def __repr__(self) -> str:
        found = self.accuracy
        return (
            f"Validation(RMSE {found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak, "
            f"{len(self.predicted_n)} recordings, {self.mismatches} ticks differ)"
        )

    @property
    def felt(self) -> list[str]:
        """Names of the recordings that are logs of sessions of this scene."""
        return [item.name for item in self.recordings if is_log_of(item, self.manifest["hash"])]

    def as_dict(self) -> dict[str, Any]:
        """Keys of `validate --json`."""
        errors = asdict(self.accuracy)
        return {
            "ramped_samples": errors.pop("ramped"),
            "mean_recording_rmse_interval_n": errors.pop("interval_n"),
            **errors,
            **error_ratios(self.accuracy, self.floor),
            **slope_keys(self.slopes),
            "model_rmse_n": self.model_rmse_n,
            "rendering_n": self.rendering_n,
            "mismatches": self.mismatches,
            "notes": self.notes,
            "tick_ns": shown_fields(self.ticks),
            "hash": self.manifest["hash"],
            "edited": list(self.edited),
            "seen": self.seen,
            **({"places": [asdict(error) for error in self.places]} if self.places else {}),
        }


def validate(
    folder: Path,
    recordings: Sequence[Recording],
    paced_s: float = PACED_S,
    device: str | None = None,
    accept_edited: bool = False,
) -> Validation:
    """Replay every recording from a fresh state; with `device`, through the board of that URL too.

    Raises DataError for a sampling rate that the scene cannot take, or where the C is not as
    emitted, unless that is accepted; DeviceError where the board does not answer.
    """
    emitted = read_emission(folder, accept_edited)
    plan, model = emitted.plan, emitted.model
    if plan.has_places and device is not None:
        raise UsageError("--device: a board knows no place: validate this scene without it")
    for recording in recordings:
        require_compatible(recording, model, plan.dt_s)
        if plan.has_places and recording.place_m is None and not recording.channels:
            raise DataError(
                f"{recording.name}: has no place, and this scene has a map of them: give it on "
                "import, --place X,Y"
            )
    for doubt in sign_doubts([item for item in recordings if not is_log_of(item, emitted.hash)]):
        caution(doubt)
    library = SceneLibrary(folder)
    # What the C carries is a part of it; the hash is of what was built, edits and all.
    stored = json.loads((folder / "manifest.json").read_text())
    library.manifest = {**stored, **library.manifest, "hash": emitted.hash}
    opened: AbstractContextManager[Any] = nullcontext()
    if device is not None:
        opened = required_part("board-replay", "--device")(device, plan, emitted.hash)
    with opened as board:
        found = _validated(plan, library, recordings, paced_s, board)
    return replace(
        _with_parts(found, model, plan, recordings),
        edited=emitted.edited,
        seen=seen_by(model, recordings),
    )


def _with_parts(
    found: Validation, model: Model, plan: Plan, recordings: Sequence[Recording]
) -> Validation:
    """The error in its parts: of the model, and of what renders it; logs of sessions apart."""
    model = replace(model, dt_s=plan.dt_s)  # of a scene with a rate of its own, which is as exact
    errors, added = [], []
    pairs = zip(recordings, found.predicted_n, strict=True)
    objects = [pair for pair in pairs if not is_log_of(pair[0], found.manifest["hash"])]
    alone = limited_each_n(model, [at_ticks(recording, plan.dt_s) for recording, _ in objects])
    for (recording, force_n), ticks_n in zip(objects, alone, strict=True):
        alone_n = at_samples(ticks_n, recording, plan.dt_s)
        errors.append(alone_n - recording.force_n)
        added.append(force_n - alone_n)
    if not errors:
        return found
    return replace(
        found,
        model_rmse_n=rms(np.concatenate(errors)),
        rendering_n=rms(np.concatenate(added)),
    )


def fail_on_mismatch(folder: Path, validation: Validation) -> None:
    """Raise MismatchError where C and reference differed in a tick."""
    if validation.mismatches:
        raise MismatchError(
            f"{folder}: C and its numpy reference differ in {validation.mismatches} of "
            f"{validation.accuracy.samples} ticks: check the compiler (CC, `springpot doctor`)"
        )


def _validated(
    plan: Plan,
    library: SceneLibrary,
    recordings: Sequence[Recording],
    paced_s: float,
    board: Any,
) -> Validation:
    replay = Replay(library)
    predicted: dict[int, NDArray[np.float64]] = {}
    ramps = dict.fromkeys(range(len(recordings)), 0)
    logs: set[int] = set()
    mismatches = 0
    counts = dict.fromkeys(NOTE_NAMES.values(), 0)
    ticked = [at_ticks(recording, plan.dt_s) for recording in recordings]
    for motion in counted(motions_of(plan, ticked), "replaying"):
        position = motion.depth_m.astype(plan.dtype)
        velocity = backward_velocity(position, plan.dt_s)
        place_m = recordings[motion.recordings[0]].place_m if plan.has_places else None
        force, notes = replay.run(position, velocity, place_m=place_m)
        predicted_m = proxy_positions(plan, library, position, velocity, place_m)
        places = [] if place_m is None else [(0, place_m)]
        reference = run_reference(plan, position, velocity, predicted_m, places)
        mismatches += int(
            np.sum(bits_differ(force, reference.force_n) | (notes != reference.notes))
        )
        first = recordings[motion.recordings[0]]
        again = repeat_session(replay, first, library.manifest["hash"])
        if again is None:
            ramps[motion.recordings[0]] = samples_of(start_up_ramp(notes), first, plan.dt_s)
        else:
            logs.add(motion.recordings[0])
            force, notes, differs = again
            mismatches += differs
        if board is not None:
            force, others = board.compared(replay, position, velocity)
            mismatches += others
        for bit, name in NOTE_NAMES.items():
            counts[name] += int(np.sum(notes & bit != 0))
        for number, start in zip(motion.recordings, motion.starts, strict=True):
            its = slice(start, start + len(ticked[number].force_n))
            force_n = force[its].astype(np.float64)
            predicted[number] = at_samples(force_n, recordings[number], plan.dt_s)
    in_order = tuple(predicted[number] for number in range(len(recordings)))
    longest = max(ticked, key=lambda recording: len(recording.position_m))
    position = longest.position_m.astype(plan.dtype)
    velocity = backward_velocity(position, plan.dt_s)
    return Validation(
        accuracy=accuracy(
            [recording.force_n for recording in recordings], in_order, list(ramps.values())
        ),
        mismatches=mismatches,
        notes=counts,
        ticks=replay.tick_times(position, velocity, plan.dt_s, paced_s),
        predicted_n=in_order,
        manifest=library.manifest,
        floor=find_noise_floor([r for i, r in enumerate(recordings) if i not in logs]),
        recordings=tuple(recordings),
        slopes=slope_errors(recordings, in_order, list(ramps.values())),
        places=place_errors(recordings, in_order, list(ramps.values())),
    )


def is_log_of(recording: Recording, scene_hash: str) -> bool:
    """Whether a recording is the log of a session of that scene."""
    session = recording.details.get("session")
    return bool(session and recording.channels and session["hash"] == scene_hash)


def repeat_session(
    replay: Replay, recording: Recording, scene_hash: str
) -> tuple[NDArray[Any], NDArray[Any], int] | None:
    """Make the calls of a session's log again: forces (n,), N, notes, and ticks of other bits.

    None for what is no log of this scene.
    """
    if not is_log_of(recording, scene_hash):
        if recording.channels and (session := recording.details.get("session")):
            caution(
                f"{recording.name}: the log of another scene ({session['hash'][:12]}): its forces "
                "are compared as a recording's"
            )
        return None
    channels, call = recording.channels, recording.channels["call"].astype(int)
    force, notes = replay.repeat(channels, recording.place_m)
    other = notes != channels["notes"].astype(int)
    if force.ndim == 2:
        for column, name in enumerate(LATERAL[2:]):
            other |= bits_differ(force[:, column].copy(), channels[name].astype(force.dtype))
        force = force[:, 2].copy()
    logged = channels["returned_n"].astype(force.dtype)
    other |= bits_differ(force, logged)
    felt = recording.force_n.astype(force.dtype)
    sent_otherwise = bits_differ(felt, logged) & ((call & (SILENT | UNSENT)) == 0)
    silenced = (call & (NONE | SILENT | UNSENT)) != 0
    mismatches = int(np.sum((other | sent_otherwise) & ((call & NONE) == 0)))
    return np.where(silenced, felt, force), notes, mismatches


def proxy_positions(
    plan: Plan,
    library: SceneLibrary,
    position: NDArray[Any],
    velocity: NDArray[Any],
    place_m: tuple[float, float] | None = None,
) -> NDArray[Any] | None:
    """Where the C's proxy is before each tick, (n,), m; the reference proves it. None without."""
    if not plan.at_proxy:
        return None
    offset = member_offset(plan, "couple")
    state = library.new_state()
    if place_m is not None:
        state.place(place_m)
    found = np.zeros_like(position)
    for i in range(len(position) - 1):
        state.step(float(position[i]), float(velocity[i]))
        found[i + 1] = state.real_at(offset)
    return found


def bits_differ(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.bool_]:
    """Where two arrays of the same type are not the same, bit for bit."""
    bits = np.uint32 if one.dtype == np.float32 else np.uint64
    result: NDArray[np.bool_] = one.view(bits) != other.view(bits)
    return result
