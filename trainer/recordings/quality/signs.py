"""Signs of the channels of a recording, as its data say.

Signs that are both turned round make a mirrored object: position and force still rise together.
What tells are the force of no contact, which is least outside, and the slope, which grows as more
of an object is pressed. One sign turned round makes an object that gives energy.
"""

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.quality.finding import Finding, refusal, three_digits, warning
from springpot.trainer.recordings.quality.sign_evidence import (
    begins_at_no_force,
    correlation,
    deeper_by_force,
    deeper_by_slope,
    deeper_from_zero,
    dissipation,
    looks_exchanged,
)
from springpot.trainer.recordings.quality.spikes import hold_spikes
from springpot.trainer.recordings.recording import Recording

_ENERGY = 0.01  # of travel times range of force: less is the sensors' alignment
_WRONG_SIGN = -0.5  # correlation of the channels
_POSITION_ZEROS = ("zero_position_m", "contact_position_m")  # what an import took off


@dataclass(frozen=True)
class Signs:
    """The signs of one recording.

    position_sign, force_sign: what to multiply each channel by. evidence: of the direction of
    both, from 0, where the data do not say, to 4.
    by_force: whether the force alone says so, and not only the slope.
    softens: whether the slope falls with depth, with the signs above, of a force that may have been
    zeroed in the deepest press; of one that is nothing where the tool begins, foams and gels do so.
    dissipated_j: over `loops` closed loops, as recorded; None without a loop.
    energy: dissipated_j of a loop over travel and range of force, give or take energy_doubt.
    correlation: of the channels.
    """

    position_sign: int
    force_sign: int
    evidence: int
    by_force: bool
    softens: bool
    dissipated_j: float | None
    loops: int
    energy: float
    energy_doubt: float
    correlation: float

    @property
    def right(self) -> bool:
        return self.position_sign == self.force_sign == 1

    @property
    def gives_energy(self) -> bool:
        return self.energy + self.energy_doubt < -_ENERGY

    @property
    def words(self) -> str:
        """One line for people."""
        inwards = "into" if self.position_sign > 0 else "out of"
        pushes = "out" if self.force_sign > 0 else "in"
        text = f"position grows {inwards} the object, force grows as it pushes {pushes}"
        if not self.evidence:
            text = f"if {text} (these data do not say which way is in)"
        if self.dissipated_j is None:
            return f"{text}; no closed loop shows its loss"
        turn = "clockwise, dissipating" if self.dissipated_j >= 0 else "anticlockwise, giving"
        count = "the loop turns" if self.loops == 1 else f"{self.loops} loops turn"
        return f"{text}: {count} {turn} {three_digits(abs(self.dissipated_j), 'J')}"

    def metadata(self) -> dict[str, Any]:
        """JSON values; signs are those to multiply by."""
        return {
            "position_sign": self.position_sign,
            "force_sign": self.force_sign,
            "evidence": self.evidence,
            "dissipated_j": self.dissipated_j,
            "loops": self.loops,
            "words": self.words,
        }


def find_signs(recording: Recording) -> Signs:
    """Signs of a recording by itself; what an importer subtracted is added again."""
    x = recording.position_m
    raw_n = recording.force_n + float(recording.details.get("zero_force_n", 0.0))
    together = correlation(x, raw_n)
    lost = dissipation(x, raw_n)
    size_j = max(lost.loops, 1) * float(np.ptp(x)) * float(np.ptp(raw_n))
    energy, doubt = (j / size_j if size_j else 0.0 for j in (lost.energy_j, lost.doubt_j))
    # A lead of more than a quarter turn is no material's: one of the signs is wrong.
    relative = -1 if together < 0.0 else 1
    force_vote, shape_vote = deeper_by_force(x, raw_n), deeper_by_slope(x, raw_n)
    raw_m = x + sum(float(recording.details.get(key, 0.0)) for key in _POSITION_ZEROS)
    force_vote = force_vote or deeper_from_zero(raw_m, raw_n + recording.details.get("tare_n", 0.0))
    if not lost.loops and shape_vote * (x[-1] - x[0]) < 0.0:
        shape_vote = 0  # without a way back the object relaxes along the stroke: its slope falls
    if shape_vote < 0 and (tare_n := float(recording.details.get("tare_n", 0.0))):
        # Of an object that is mirrored, what was found for free air is its deepest press.
        force_vote = min(force_vote, deeper_by_force(x, raw_n + tare_n))
    zeroed = "zero_force_n" in recording.details or "tare_n" in recording.details
    sure = force_vote > 0 and not zeroed and begins_at_no_force(x, raw_n)
    evidence = force_vote + shape_vote
    inwards = -1 if evidence < 0 else 1  # the end of deeper positions
    return Signs(
        position_sign=inwards,
        force_sign=inwards * relative,
        evidence=abs(evidence),
        by_force=force_vote * inwards > 0,
        softens=shape_vote * inwards < 0 and not sure,
        dissipated_j=lost.energy_j if lost.loops else None,
        loops=lost.loops,
        energy=energy,
        energy_doubt=doubt,
        correlation=together,
    )


def signs_of_all(all_signs: Sequence[Signs]) -> Signs:
    """Signs of a set of accepted recordings: those of the recording with the strongest evidence.

    Dissipation is summed over all loops.
    """
    surest = max(all_signs, key=lambda signs: signs.evidence)
    dissipated = [signs.dissipated_j for signs in all_signs if signs.dissipated_j is not None]
    return replace(
        surest,
        dissipated_j=sum(dissipated) if dissipated else None,
        loops=sum(signs.loops for signs in all_signs),
    )


def sign_findings(recording: Recording, signs: Signs) -> Iterator[Finding]:
    """Yield what has to be turned round, or is no object; a warning where it was accepted."""
    for finding in _sign_findings(recording, signs):
        if finding.severity == "warning":
            yield finding
        elif recording.signs_accepted:
            taken = "taken as it is, as import was told (--accept-signs)"
            yield replace(finding, severity="warning", to_do=taken)
        else:
            yield replace(finding, so_what=f"{finding.so_what} (--accept-signs takes it so)")


def _sign_findings(recording: Recording, signs: Signs) -> Iterator[Finding]:
    opposite = signs.position_sign != signs.force_sign
    if opposite and (signs.correlation < _WRONG_SIGN or signs.gives_energy):
        yield refusal(
            "sign", recording.name,
            f"force falls as position rises (correlation {signs.correlation:.2f})",
            "the model would pull the hand in", _remedy(recording, signs),
        )  # fmt: skip
    elif opposite:
        yield warning(
            "sign", recording.name,
            f"force rather falls as position rises (correlation {signs.correlation:.2f})",
            "this is the force of a mass, of a late sensor or of something that gives way",
            "remove the mass (--mass-kg) or the delays (--align), or press what does not give way",
        )  # fmt: skip
    elif signs.gives_energy:
        yield refusal(
            "energy", recording.name, f"{signs.words.partition(': ')[2]}, and no object gives any",
            "the model would drive the hand",
            "take the right columns (--map), state how late force is sampled (--force-delay-s "
            "with --align), or take out play between the sensor of position and the tool",
        )  # fmt: skip
    elif not signs.right and signs.by_force:
        yield refusal(
            "sign", recording.name, "both channels are negative where the object is pressed",
            "the model would be its mirror image, stiff at the surface",
            _remedy(recording, signs),
        )  # fmt: skip
    elif signs.softens or not signs.right:
        yield _softening(recording, signs)


def _softening(recording: Recording, signs: Signs) -> Finding:
    what = "the slope of force falls as position grows"
    if looks_exchanged(recording.position_m, recording.force_n):
        return warning(
            "exchanged", recording.name, f"{what}, and position rests while force goes out and in",
            "columns of position and force that are exchanged do so",
            f"if they are, import with --map {shlex.quote(_exchanged(recording))}",
        )  # fmt: skip
    mirrored = replace(signs, position_sign=-1, force_sign=-1)
    return warning(
        "softening", recording.name, what,
        "a foam, a gel and what is pulled or buckles do so; so does a mirror image",
        f"if force was zeroed in the deepest press, {_remedy(recording, mirrored)}",
    )  # fmt: skip


def sign_doubts(recordings: Sequence[Recording]) -> list[str]:
    """Lines on recordings with signs that no object has, where they are compared with a model."""
    return [
        finding.text
        for recording in recordings
        for finding in sign_findings(recording, find_signs(hold_spikes(recording)[0]))
        if finding.severity == "refusal"
    ]


def require_signs(recordings: Sequence[Recording]) -> None:
    """Raise DataError for the first recording with signs that no object has."""
    for recording in recordings:
        for doubt in sign_doubts([recording]):
            raise DataError(doubt)


def _remedy(recording: Recording, signs: Signs) -> str:
    """Option `--map` that turns the signs round."""
    by_channel = {"position": signs.position_sign, "force": signs.force_sign}
    if not signs.evidence and signs.position_sign != signs.force_sign:
        either = (shlex.quote(_turned(recording, channel)) for channel in by_channel)
        return f"turn one sign round on import: --map {' or --map '.join(either)}"
    turned = ",".join(_turned(recording, c) for c, sign in by_channel.items() if sign < 0)
    return f"turn the sign round on import: --map {shlex.quote(turned)}"


def _exchanged(recording: Recording) -> str:
    """Value of `--map` by which each channel is read from the other one's column."""
    position, force = (recording.details.get("units", {}).get(c, {}) for c in ("position", "force"))
    return (
        f"position={force.get('column', 'COL')}:{position.get('unit') or 'mm'},"
        f"force={position.get('column', 'COL')}:{force.get('unit') or 'N'}"
    )


def _turned(recording: Recording, channel: str) -> str:
    metadata = recording.details.get("units", {}).get(channel, {})
    unit = metadata.get("unit") or {"position": "mm", "force": "N"}[channel]
    if unit.startswith("-"):
        opposite = re.sub(r"^-(1(?![\d.]))?", "", unit)
    else:
        opposite = f"-{unit}" if unit[0] in "0123456789." else f"-1{unit}"
    return f"{channel}={metadata.get('column', 'COL')}:{opposite}"
