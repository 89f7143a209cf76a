"""Recordings through the C of a scene, and the ticks in which its reference has other bits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.emit.golden import backward_velocity
from springpot.codegen.messages import caution, counted
from springpot.codegen.plan import Plan, member_offset
from springpot.codegen.reference import run_reference
from springpot.host.metrics import start_up_ramp
from springpot.host.native.loop_library import NONE, SILENT, UNSENT
from springpot.host.native.replay import Replay, motions_of
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session.outcome import NOTE_NAMES, clamped_low
from springpot.host.validation.ticks import at_samples, samples_of
from springpot.trainer.recordings.recording import Recording


@dataclass(frozen=True, eq=False)
class Compared:
    """Hold what the C returned along recordings, in their order.

    force_n: along the depth, (n,), N. ramped: samples of each in the start-up ramp. logs: numbers
    of those that are logs of sessions of the scene. clamped_low: ticks that were clamped at
    the lower limit. mismatches: ticks of other bits.
    """

    force_n: tuple[Samples, ...]
    ramped: tuple[int, ...]
    logs: frozenset[int]
    notes: dict[str, int]
    clamped_low: int
    mismatches: int


def compared_all(
    plan: Plan,
    library: SceneLibrary,
    recordings: Sequence[Recording],
    ticked: Sequence[Recording],
) -> Compared:
    """Run every recording from a fresh state, or those of a session in a row.

    ticked: the recordings at the ticks of the scene.
    """
    replay, scene_hash = Replay(library), library.manifest["hash"]
    predicted: dict[int, Samples] = {}
    ramps = [0] * len(recordings)
    logs: set[int] = set()
    low = 0
    mismatches = 0
    counts = dict.fromkeys(NOTE_NAMES.values(), 0)
    for motion in counted(motions_of(plan, ticked), "replaying"):
        number = motion.recordings[0]
        first = recordings[number]
        position = motion.depth_m.astype(plan.dtype)
        velocity = backward_velocity(position, plan.dt_s)
        force, notes, differs = _pressed(plan, library, replay, position, velocity, first)
        again = repeat_session(replay, first, scene_hash)
        if again is None:
            ramps[number] = samples_of(start_up_ramp(notes), first, plan.dt_s)
        else:
            logs.add(number)
            force, notes, others = again
            differs += others
        mismatches += differs
        low += int(clamped_low(notes, force, float(plan.output.min_n)).sum())
        for bit, name in NOTE_NAMES.items():
            counts[name] += int(np.sum(notes & bit != 0))
        for k, start in zip(motion.recordings, motion.starts, strict=True):
            its = slice(start, start + len(ticked[k].force_n))
            predicted[k] = at_samples(force[its].astype(np.float64), recordings[k], plan.dt_s)
    return Compared(
        tuple(predicted[k] for k in range(len(recordings))), tuple(ramps), frozenset(logs),
        counts, low, mismatches,
    )  # fmt: skip


def _pressed(
    plan: Plan,
    library: SceneLibrary,
    replay: Replay,
    position: Reals,
    velocity: Reals,
    first: Recording,
) -> tuple[Reals, Reals, int]:
    """Forces (N) and notes of the C, (n,), and ticks in which the reference differs."""
    place_m = first.place_m if plan.has_places else None
    force, notes = replay.run(position, velocity, place_m=place_m)
    predicted_m = proxy_positions(plan, library, position, velocity, place_m)
    places = [] if place_m is None else [(0, place_m)]
    reference = run_reference(plan, position, velocity, predicted_m, places)
    other = bits_differ(force, reference.force_n) | (notes != reference.notes)
    return force, notes, int(np.sum(other))


def is_log_of(recording: Recording, scene_hash: str) -> bool:
    """Return whether a recording is the log of a session of that scene."""
    session = recording.details.get("session")
    return bool(session and recording.channels and session["hash"] == scene_hash)


def repeat_session(
    replay: Replay, recording: Recording, scene_hash: str
) -> tuple[Reals, Reals, int] | None:
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
    position: Reals,
    velocity: Reals,
    place_m: tuple[float, float] | None = None,
) -> Reals | None:
    """Return where the proxy of the C is before each tick, (n,), m; None in a scene without one."""
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


def bits_differ(one: Reals, other: Reals) -> NDArray[np.bool_]:
    """Return where two arrays of one type have other bits."""
    bits = np.uint32 if one.dtype == np.float32 else np.uint64
    result: NDArray[np.bool_] = one.view(bits) != other.view(bits)
    return result
