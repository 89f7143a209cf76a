"""Signs of the channels of a recording, as its data say.

Signs that are both turned round make a mirrored object: position and force still rise together.
What tells are the force of no contact, which is least outside, and the slope, which grows as more
of an object is pressed. One sign turned round makes an object that gives energy.
"""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from springpot.codegen.arrays import Flags, Samples
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.formats.units import parts_of
from springpot.trainer.recordings.quality.dissipation import (
    END,
    MIN_SAMPLES,
    Dissipation,
    dissipation,
)
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.quality.spikes import hold_spikes
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.signals import noise_n

_NOTHING = 0.05  # of the greatest force
_FIRST, _SET_OFF = 5, 0.01  # samples, while the tool has not gone farther, of the travel
_CLEAR, _STRONG = 1.25, 2.0  # ratio of the ends: some evidence, and twice as much
_SURE = 10.0  # standard deviations
_FALLEN, _SLOWER = 0.4, 3.0  # of the greatest force; times as long for the same way
_ENERGY = 0.01  # of travel times range of force: less is the sensors' alignment
_WRONG_SIGN = -0.5  # correlation of the channels
_POSITION_ZEROS = ("zero_position_m", "contact_position_m")  # what an import took off


def failure_row(x: Samples, f: Samples) -> int | None:
    """Row of the greatest force, if the object tears or yields beyond it; None if it does not.

    There force is less than 0.4 of it, in a twentieth of the way that the tool goes through as
    fast as before: an object that flows loses its force where the tool slows down.
    """
    rise = np.abs(f - first_n(x, f))
    peak = int(np.argmax(rise))
    if x[peak] == x[0] or rise[peak] < _SURE * noise_n(f):
        return None
    way = np.sign(x[peak] - x[0]) * x
    farthest = np.maximum.accumulate(way)
    rows = np.searchsorted(farthest, np.arange(way[0], farthest[-1], END * float(np.ptp(x))))
    before = np.diff(rows[rows <= peak])
    usual = float(np.median(before)) if len(before) else 0.0
    for begin, end in pairwise(rows[rows > peak].tolist()):
        fallen = float(np.median(rise[begin : end + 1])) < _FALLEN * float(rise[peak])
        if fallen and end - begin <= _SLOWER * usual:
            return peak
    return None


def correlation(x: Samples, f: Samples) -> float:
    """Correlation of position and force, (n,) both; 0 if one is constant."""
    return float(np.corrcoef(x, f)[0, 1]) if min(np.ptp(x), np.ptp(f)) else 0.0


def deeper_by_force(x: Samples, f: Samples) -> int:
    """Vote for the end of larger force: 2 or 1 the upper one, 0 unknown, negative the lower one."""
    width = END * float(np.ptp(x))
    low = abs(float(np.median(f[x <= x.min() + width])))
    high = abs(float(np.median(f[x >= x.max() - width])))
    less, more = sorted((abs(float(f.min())), abs(float(f.max()))))
    two_sided = f.min() < 0.0 < f.max() and less > _NOTHING * more
    return 0 if two_sided else _vote(high, low)


def deeper_from_zero(x: Samples, f: Samples) -> int:
    """Vote, as in `deeper_by_force`, for the end far from 0, where position and force begin at 0.

    An object that is bonded to the tool pulls on the way back, so that no end is free of force: it
    pushes harder at the farthest position, and the tool does not go beyond 0 to the other side.
    """
    span = float(np.ptp(x))
    side = 1 if x.max() > -x.min() else -1
    away, force = side * x, side * f
    far_n = float(np.median(force[away >= away.max() - END * span]))
    begins = abs(float(x[0])) <= END * span and abs(first_n(x, force)) < _NOTHING * far_n
    alone = away.min() >= -END * span and far_n > -float(force.min())
    return 2 * side if begins and alone else 0


def first_n(x: Samples, f: Samples) -> float:
    """Force where a recording begins: the median of the samples before the tool sets off."""
    gone = np.abs(x[:_FIRST] - x[0]) > _SET_OFF * float(np.ptp(x))
    return float(np.median(f[: int(np.argmax(gone)) if gone.any() else _FIRST]))


def deeper_by_slope(x: Samples, f: Samples) -> int:
    """Vote for the stiffer third of the travel, as in `deeper_by_force`.

    A level that a sensor's limit or free air makes is no slope of the object.
    """
    level = f == f.max()
    if np.ptp(x[level]) > END * np.ptp(x):
        x, f = x[~level], f[~level]
    if not len(x):
        return 0
    low_m, third_m = float(x.min()), float(np.ptp(x)) / 3
    low = _slope(x, f, x <= low_m + third_m)
    high = _slope(x, f, x >= low_m + 2 * third_m)
    if low is None or high is None:
        return 0
    return _vote(abs(high), abs(low))


def _vote(high: float, low: float) -> int:
    larger, smaller = max(high, low), min(high, low)
    size = 2 if larger > _STRONG * smaller else 1 if larger > _CLEAR * smaller else 0
    return size if high > low else -size


def _slope(x: Samples, f: Samples, part: Flags) -> float | None:
    off = x[part] - x[part].mean()
    spread = float(off @ off)
    if len(off) < MIN_SAMPLES or spread == 0.0:
        return None
    return float(off @ f[part]) / spread


@dataclass(frozen=True)
class Signs:
    """The signs of one recording, up to where the object fails.

    position_sign, force_sign: what to multiply each channel by. evidence: of the direction of
    both, from 0, where the data do not say, to 4.
    by_force: whether the force alone says so, and not only the slope.
    correlation: of the channels. failure_row: of the greatest force before the object tears.
    """

    position_sign: int
    force_sign: int
    evidence: int
    by_force: bool
    lost: Dissipation
    correlation: float
    failure_row: int | None

    @property
    def words(self) -> str:
        """One line for people."""
        inwards = "into" if self.position_sign > 0 else "out of"
        pushes = "out" if self.force_sign > 0 else "in"
        text = f"position grows {inwards} the object, force grows as it pushes {pushes}"
        unknown = f"if {text} (these data do not say which way is in)"
        return f"{text if self.evidence else unknown}: {self.lost.words}"

    def metadata(self) -> JsonObject:
        """JSON values; signs are those to multiply by."""
        return {
            **{key: getattr(self, key) for key in ("position_sign", "force_sign", "evidence")},
            "dissipated_j": self.lost.energy_j if self.lost.loops else None,
            "loops": self.lost.loops,
            "words": self.words,
        }


def find_signs(recording: Recording) -> Signs:
    """Signs of a recording by itself; what an importer subtracted is added again."""
    details, x = recording.details, recording.position_m
    raw_n = recording.force_n + float(details.get("zero_force_n", 0.0))
    if (failed := failure_row(x, raw_n)) is not None:
        x, raw_n = x[: failed + 1], raw_n[: failed + 1]
    lost = dissipation(x, raw_n)
    # After one way in, a hold relaxes and creeps against its sign.
    peak = int(np.argmax(np.abs(raw_n - first_n(x, raw_n))))
    rows = len(x) if lost.loops else max(MIN_SAMPLES, peak + 1)
    together = correlation(x[:rows], raw_n[:rows])
    # A lead of more than a quarter turn is no material's: one of the signs is wrong.
    relative = -1 if together < 0.0 else 1
    force_vote, shape_vote = deeper_by_force(x, raw_n), deeper_by_slope(x, raw_n)
    raw_m = x + sum(float(details.get(key, 0.0)) for key in _POSITION_ZEROS)
    untared_n = raw_n + float(details.get("tare_n", 0.0))
    force_vote = force_vote or deeper_from_zero(raw_m, untared_n)
    if not lost.loops and shape_vote * (x[-1] - x[0]) < 0.0:
        shape_vote = 0  # without a way back the object relaxes along the stroke: its slope falls
    if shape_vote < 0 and details.get("tare_n"):
        # Of an object that is mirrored, what was found for free air is its deepest press.
        force_vote = min(force_vote, deeper_by_force(x, untared_n))
    evidence = force_vote + shape_vote
    inwards = -1 if evidence < 0 else 1  # the end of deeper positions
    own = (inwards, inwards * relative, abs(evidence), force_vote * inwards > 0)
    return Signs(*own, lost, together, failed)


def sign_findings(recording: Recording, signs: Signs) -> Iterator[Finding]:
    """Yield what has to be turned round, or is no object; a warning where it was accepted."""
    if found := _sign_finding(recording, signs):
        if found.severity == "refusal" and recording.signs_accepted:
            found = replace(found, severity="warning", to_do="accepted by --accept-signs")
        elif found.severity == "refusal":
            found = replace(found, so_what=f"{found.so_what} (--accept-signs takes it so)")
        yield found
    if signs.failure_row is not None:
        peak_n, at_s = recording.force_n[signs.failure_row], signs.failure_row * recording.dt_s
        yield warning(
            "tear", recording.name,
            f"force falls from {peak_n:.3g} N at {at_s:.4g} s while the tool goes on",
            "the object tears or yields there, and no model does", "cut the recording there",
        )  # fmt: skip


def _sign_finding(recording: Recording, signs: Signs) -> Finding | None:
    name, remedy = recording.name, _remedy(recording, signs)
    falls = f"falls as position rises (correlation {signs.correlation:.2f})"
    gives = signs.lost.energy + signs.lost.doubt < -_ENERGY
    if signs.position_sign != signs.force_sign:
        if gives or signs.correlation < _WRONG_SIGN:
            pulls = "the model would pull the hand in"
            return refusal("sign", name, f"force {falls}", pulls, remedy)
        mend = "remove the mass, --mass-kg KG, or the delay, --force-delay-s SECONDS --align"
        return warning("sign", name, f"force rather {falls}", "mass and a late sensor do so", mend)
    if gives:
        return refusal(
            "energy", name, f"{signs.lost.words}, and no object gives any",
            "the model would drive the hand", "take the right columns (--map), or state how late "
            "force is sampled, --force-delay-s SECONDS --align",
        )  # fmt: skip
    if signs.position_sign < 0 and signs.by_force:
        what = "both channels are negative where the object is pressed"
        return refusal("sign", name, what, "the model would be its mirror image", remedy)
    return None


def sign_doubts(recordings: Sequence[Recording]) -> list[str]:
    """Lines on recordings with signs that no object has, where they are compared with a model."""
    held = [hold_spikes(recording)[0] for recording in recordings]
    found = [finding for each in held for finding in sign_findings(each, find_signs(each))]
    return [finding.text for finding in found if finding.severity == "refusal"]


def _remedy(recording: Recording, signs: Signs) -> str:
    """Option `--map` that turns the signs round."""
    by_channel = {"position": signs.position_sign, "force": signs.force_sign}
    if not signs.evidence and signs.position_sign != signs.force_sign:
        either = (shlex.quote(_turned(recording, channel)) for channel in by_channel)
        return f"turn one sign round on import: --map {' or --map '.join(either)}"
    turned = ",".join(_turned(recording, c) for c, sign in by_channel.items() if sign < 0)
    return f"turn the sign round on import: --map {shlex.quote(turned)}"


def _turned(recording: Recording, channel: str) -> str:
    read = recording.details.get("units", {}).get(channel, {})
    factor, unit = parts_of(read.get("unit") or {"position": "mm", "force": "N"}[channel])
    return f"{channel}={read.get('column', 'COL')}:{-factor:g}{unit}"
