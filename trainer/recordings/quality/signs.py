"""Signs of the channels of a recording, as its data say.

Signs that are both turned round make a mirrored object: position and force still rise together.
What tells are the force of no contact, which is least outside, and the slope, which grows as more
of an object is pressed. One sign turned round makes an object that gives energy.
"""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.formats.units import parts_of
from springpot.trainer.recordings.quality.finding import Finding, refusal, three_digits, warning
from springpot.trainer.recordings.quality.sign_evidence import (
    MIN_SAMPLES,
    Dissipation,
    correlation,
    deeper_by_force,
    deeper_by_slope,
    deeper_from_zero,
    dissipation,
    failure_row,
    peak_row,
)
from springpot.trainer.recordings.quality.spikes import hold_spikes
from springpot.trainer.recordings.recording import Recording

_ENERGY = 0.01  # of travel times range of force: less is the sensors' alignment
_WRONG_SIGN = -0.5  # correlation of the channels
_POSITION_ZEROS = ("zero_position_m", "contact_position_m")  # what an import took off


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
        return f"{text if self.evidence else unknown}: {_loss(self.lost)}"

    def metadata(self) -> JsonObject:
        """JSON values; signs are those to multiply by."""
        return {
            **{key: getattr(self, key) for key in ("position_sign", "force_sign", "evidence")},
            "dissipated_j": self.lost.energy_j if self.lost.loops else None,
            "loops": self.lost.loops,
            "words": self.words,
        }

    @staticmethod
    def of_all(signs: Sequence["Signs"]) -> "Signs":
        """Signs of the recording with the strongest evidence, with the loops of all."""
        energies_j = sum(own.lost.energy_j for own in signs)
        lost = Dissipation(energies_j, sum(own.lost.loops for own in signs))
        return replace(max(signs, key=lambda own: own.evidence), lost=lost)


def find_signs(recording: Recording) -> Signs:
    """Signs of a recording by itself; what an importer subtracted is added again."""
    details, x = recording.details, recording.position_m
    raw_n = recording.force_n + float(details.get("zero_force_n", 0.0))
    if (failed := failure_row(x, raw_n)) is not None:
        x, raw_n = x[: failed + 1], raw_n[: failed + 1]
    lost = dissipation(x, raw_n)
    # After one way in, a hold relaxes and creeps against its sign.
    rows = len(x) if lost.loops else max(MIN_SAMPLES, peak_row(x, raw_n) + 1)
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
        return warning("sign", name, f"force rather {falls}", "a mass and a late sensor do so",
                       "remove the mass (--mass-kg) or the delay (--align)")  # fmt: skip
    if gives:
        return refusal(
            "energy", name, f"{_loss(signs.lost)}, and no object gives any",
            "the model would drive the hand", "take the right columns (--map), or state how late "
            "force is sampled (--force-delay-s with --align)",
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


def _loss(lost: Dissipation) -> str:
    if not lost.loops:
        return "no closed loop shows its loss"
    turn = "clockwise, dissipating" if lost.energy_j >= 0 else "anticlockwise, giving"
    count = "the loop turns" if lost.loops == 1 else f"{lost.loops} loops turn"
    return f"{count} {turn} {three_digits(abs(lost.energy_j), 'J')}"


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
