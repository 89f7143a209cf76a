"""Recordings through the C of a scene: at its ticks, against its reference, by place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.arrays import Flags, Reals, Samples
from springpot.codegen.emit.golden import differentiate
from springpot.codegen.messages import caution, with_progress
from springpot.codegen.plan import Plan, member_offset
from springpot.codegen.reference import run_reference
from springpot.host.metrics import accuracy, start_up_ramp
from springpot.host.native.c_library import NONE, SILENT, UNSENT
from springpot.host.native.replay import Replay, replay_motions
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session.outcome import NOTE_NAMES, clamped_at_lower_limit
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.recordings.recording import Recording, format_site, group_by_site

_SAME_RATE = 1e-3  # apart, relatively: one rate, as `require_compatible` has it


def resample_to_ticks(recording: Recording, dt_s: float) -> Recording:
    """Return a recording at a scene's time step; itself, if that is its own."""
    if abs(recording.dt_s / dt_s - 1.0) <= _SAME_RATE:
        return recording
    own_s = np.arange(len(recording.position_m)) * recording.dt_s
    tick_s = np.arange(int(own_s[-1] / dt_s + 1e-6) + 1) * dt_s
    return replace(
        recording,
        position_m=np.interp(tick_s, own_s, recording.position_m),
        force_n=np.interp(tick_s, own_s, recording.force_n),
        dt_s=dt_s,
    )


def resample_to_samples(force_n: Samples, recording: Recording, dt_s: float) -> Samples:
    """Return forces of a scene's ticks, (ticks,), N, at the recording's samples, (samples,)."""
    if len(force_n) == len(recording.position_m):
        return force_n
    own_s = np.arange(len(recording.position_m)) * recording.dt_s
    found_n: Samples = np.interp(own_s, np.arange(len(force_n)) * dt_s, force_n)
    return found_n


def samples_at_ticks(ticks: int, recording: Recording, dt_s: float) -> int:
    """Count the recording's samples within its first `ticks` ticks."""
    return -(-ticks * round(1e6 * dt_s) // round(1e6 * recording.dt_s))


@dataclass(frozen=True, eq=False)
class Compared:
    """Forces and notes of the C along recordings, in their order.

    predicted_n: forces along the depth, (n,), N. ramped: samples of each in the start-up ramp,
    which no error counts. notes: ticks with each. clamped_low: ticks that were clamped at the lower
    limit of the force. mismatches: ticks where C and reference differ in force or notes, bit for
    bit.
    """

    predicted_n: tuple[Samples, ...]
    ramped: tuple[int, ...]
    notes: dict[str, int]
    clamped_low: int
    mismatches: int


def compare_all(
    plan: Plan, library: SceneLibrary, recordings: Sequence[Recording], ticked: Sequence[Recording]
) -> Compared:
    """Run every recording from a fresh state, or those of a session in a row.

    ticked: the recordings at the ticks of the scene.
    """
    replay, scene_hash = Replay(library), library.manifest["hash"]
    predicted: dict[int, Samples] = {}
    ramps = [0] * len(recordings)
    low = mismatches = 0
    counts = dict.fromkeys(NOTE_NAMES.values(), 0)
    for motion in with_progress(replay_motions(plan, ticked), "replaying"):
        number, begin = motion.recordings[0], motion.starts[0]
        first = recordings[number]
        position = motion.depth_m.astype(plan.dtype)
        velocity = differentiate(position, plan.dt_s)
        place_m = first.place_m if plan.has_places else None
        force, notes = replay.run(position, velocity, place_m=place_m)
        predicted_m = proxy_positions(plan, library, position, velocity, place_m)
        places = [] if place_m is None else [(0, place_m)]
        reference = run_reference(plan, position, predicted_m, places)
        other = count_different_bits(force, reference.force_n) | (notes != reference.notes)
        mismatches += int(np.sum(other))
        again = repeat_session(replay, first, scene_hash)
        if again is None:
            force, notes = force[begin:], notes[begin:]
            ramps[number] = samples_at_ticks(start_up_ramp(notes), first, plan.dt_s)
        else:
            force, notes, others = again
            mismatches += others
        low += int(clamped_at_lower_limit(notes, force, float(plan.output.min_n)).sum())
        for bit, name in NOTE_NAMES.items():
            counts[name] += int(np.sum(notes & bit != 0))
        for k, start in zip(motion.recordings, motion.starts, strict=True):
            rows = slice(start - begin, start - begin + len(ticked[k].force_n))
            predicted[k] = resample_to_samples(
                force[rows].astype(np.float64), recordings[k], plan.dt_s
            )
    forces_n = tuple(predicted[k] for k in range(len(recordings)))
    return Compared(forces_n, tuple(ramps), counts, low, mismatches)


def is_session_log(recording: Recording, scene_hash: str) -> bool:
    """Return whether a recording is the log of a session of that scene."""
    session = recording.details.get("session")
    return bool(session and recording.channels and session["hash"] == scene_hash)


def repeat_session(
    replay: Replay, recording: Recording, scene_hash: str
) -> tuple[Reals, Reals, int] | None:
    """Make the calls of a session's log again: forces (n,), N, notes, and ticks of other bits.

    None for what is no log of this scene.
    """
    if not is_session_log(recording, scene_hash):
        if recording.channels and (session := recording.details.get("session")):
            caution(
                f"{recording.name}: the log of another scene ({session['hash'][:12]}): its forces "
                "are compared as a recording's"
            )
        return None
    channels, call = recording.channels, recording.channels["call"].astype(int)
    force, notes = replay.repeat(channels, recording.place_m)
    other = notes != channels["notes"].astype(int)
    logged = channels["returned_n"].astype(force.dtype)
    other |= count_different_bits(force, logged)
    felt = recording.force_n.astype(force.dtype)
    sent_otherwise = count_different_bits(felt, logged) & ((call & (SILENT | UNSENT)) == 0)
    silenced = (call & (NONE | SILENT | UNSENT)) != 0
    mismatches = int(np.sum((other | sent_otherwise) & ((call & NONE) == 0)))
    return np.where(silenced, felt, force), notes, mismatches


def proxy_positions(
    plan: Plan,
    library: SceneLibrary,
    position: Reals,
    velocity: Reals,
    place_m: tuple[float, float] | None = None,
) -> Reals | None:
    """Return where the proxy of the C is before each tick, (n,), m; None in a scene without one."""
    if not plan.at_proxy:
        return None
    offset = member_offset(plan, "couple")
    state = library.new_state(place_m)
    proxy = np.zeros_like(position)
    for i in range(len(position) - 1):
        state.step(float(position[i]), float(velocity[i]))
        proxy[i + 1] = state.real_at(offset)
    return proxy


def count_different_bits(one: Reals, other: Reals) -> Flags:
    """Return where two arrays of one type have other bits."""
    bits = np.uint32 if one.dtype == np.float32 else np.uint64
    result: Flags = one.view(bits) != other.view(bits)
    return result


@dataclass(frozen=True)
class PlaceError:
    """Error of the C on the recordings of one place."""

    place_m: tuple[float, float]
    recordings: int
    rmse_n: float
    rmse_percent_of_peak: float


def place_errors(
    recordings: Sequence[Recording], predicted_n: Sequence[Samples], ramped: Sequence[int]
) -> tuple[PlaceError, ...]:
    """Return the error of each site, in the order of recording; none without sites.

    predicted_n: forces of the C along each, (n,), N; ramped: samples of each in the start-up ramp.
    """
    errors = []
    for place_m, numbers in group_by_site(recordings).items():
        error = accuracy(
            [recordings[k].force_n for k in numbers],
            [predicted_n[k] for k in numbers],
            [ramped[k] for k in numbers],
        )
        errors.append(PlaceError(place_m, len(numbers), error.rmse_n, error.rmse_percent_of_peak))
    return tuple(errors)


def site_sentence(errors: Sequence[PlaceError]) -> str:
    """Geometric mean and the worst place, for people; empty for fewer than two places."""
    if len(errors) < 2:
        return ""
    percents = [error.rmse_percent_of_peak for error in errors]
    worst = max(errors, key=lambda error: error.rmse_percent_of_peak)
    return (
        f"{len(errors)} places: {geometric_mean(percents):.3g} % of peak in geometric mean, worst "
        f"{worst.rmse_percent_of_peak:.3g} % at {format_site(worst.place_m)}"
    )
