"""Which way each channel of a recording points, as its data say.

Signs that are both turned round make a mirrored object: position and force still rise together.
What tells are the force of no contact, which is least outside, and the slope, which grows as more
of an object is pressed. One sign turned round makes an object that gives energy.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.quality.finding import Finding, refusal, warning
from springpot.trainer.recordings.recording import Recording

_END = 0.05  # of the travel: the force at an end is the median there
_MIN_SAMPLES = 8  # of a slope
_ONE_SIDED = 0.05  # of the larger end's force: a smaller one of the other sign is noise
_CLEAR, _STRONG = 1.25, 2.0  # ratio of the ends: some evidence, and twice as much
_ENERGY = 0.01  # of travel times range of force: less is the sensors' alignment
_LEVELS = (0.3, 0.5, 0.7)  # of the travel: where loops may be cut
_WRONG_SIGN = -0.5  # correlation of the channels


@dataclass(frozen=True)
class Signs:
    """The signs of one recording.

    position_sign, force_sign: what to multiply each channel by. evidence: of the direction of
    both, from 0, where the data do not say, to 4.
    by_force: whether the force alone says so, and not only the slope.
    softens: whether the slope falls with depth, with the signs above.
    dissipated_j: over `loops` closed loops, as recorded; None without a loop.
    energy: dissipated_j of a loop over travel and range of force; correlation: of the channels.
    """

    position_sign: int
    force_sign: int
    evidence: int
    by_force: bool
    softens: bool
    dissipated_j: float | None
    loops: int
    energy: float
    correlation: float

    @property
    def right(self) -> bool:
        return self.position_sign == self.force_sign == 1

    @property
    def gives_energy(self) -> bool:
        return self.energy < -_ENERGY

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
        return f"{text}: {count} {turn} {_energy_text(abs(self.dissipated_j))}"

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
    together = _correlation(x, raw_n)
    dissipated_j, loops = _dissipation(x, raw_n)
    size_j = float(np.ptp(x)) * float(np.ptp(raw_n))
    energy = dissipated_j / loops / size_j if loops and size_j else 0.0
    # A lead of more than a quarter turn is no material's: one of the signs is wrong.
    relative = -1 if together < 0.0 else 1
    force_vote, shape_vote = _by_force(x, raw_n), _by_slope(x, raw_n)
    evidence = force_vote + shape_vote
    inwards = -1 if evidence < 0 else 1  # the end of deeper positions
    return Signs(
        position_sign=inwards,
        force_sign=inwards * relative,
        evidence=abs(evidence),
        by_force=force_vote * inwards > 0,
        softens=shape_vote * inwards < 0,
        dissipated_j=dissipated_j if loops else None,
        loops=loops,
        energy=energy,
        correlation=together,
    )


def signs_of_all(all_signs: Sequence[Signs]) -> Signs:
    """Those of a set without a refusal: of the surest recording, with the energy of all loops."""
    surest = max(all_signs, key=lambda signs: signs.evidence)
    dissipated = [signs.dissipated_j for signs in all_signs if signs.dissipated_j is not None]
    return replace(
        surest,
        dissipated_j=sum(dissipated) if dissipated else None,
        loops=sum(signs.loops for signs in all_signs),
    )


def sign_findings(recording: Recording, signs: Signs) -> Iterator[Finding]:
    """Yield what has to be turned round, or is no object."""
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
            "this is the force of a mass or of a late sensor, not of an object",
            "remove the mass (--mass-kg) or the delays (--align)",
        )  # fmt: skip
    elif signs.gives_energy:
        yield refusal(
            "energy", recording.name, f"{signs.words.partition(': ')[2]}, and no object gives any",
            "the model would drive the hand",
            "take the right columns (--map), or state how late force is sampled "
            "(--force-delay-s with --align)",
        )  # fmt: skip
    elif not signs.right and signs.by_force:
        yield refusal(
            "sign", recording.name, "both channels are negative where the object is pressed",
            "the model would be its mirror image, stiff at the surface",
            _remedy(recording, signs),
        )  # fmt: skip
    elif signs.softens or not signs.right:
        mirrored = replace(signs, position_sign=-1, force_sign=-1)
        yield warning(
            "softening", recording.name, "the slope of force falls as position grows",
            "this is an object that is pulled or buckles, or both signs are turned round",
            f"if it was pressed, {_remedy(recording, mirrored)}",
        )  # fmt: skip


def require_signs(recordings: Sequence[Recording]) -> None:
    """Raise DataError for the first recording whose signs are none of an object."""
    for recording in recordings:
        for finding in sign_findings(recording, find_signs(recording)):
            if finding.severity == "refusal":
                raise DataError(finding.line.removeprefix("refusal: "))


def _remedy(recording: Recording, signs: Signs) -> str:
    """Which `--map` turns the signs round."""
    by_channel = {"position": signs.position_sign, "force": signs.force_sign}
    if not signs.evidence and signs.position_sign != signs.force_sign:
        either = (_turned(recording, channel) for channel in by_channel)
        return f"turn one sign round on import: --map {' or --map '.join(either)}"
    turned = ",".join(_turned(recording, c) for c, sign in by_channel.items() if sign < 0)
    return f"turn the sign round on import: --map {turned}"


def _turned(recording: Recording, channel: str) -> str:
    metadata = recording.details.get("units", {}).get(channel, {})
    unit = metadata.get("unit") or {"position": "mm", "force": "N"}[channel]
    if unit.startswith("-"):
        opposite = re.sub(r"^-(1(?![\d.]))?", "", unit)
    else:
        opposite = f"-{unit}" if unit[0] in "0123456789." else f"-1{unit}"
    return f"{channel}={metadata.get('column', 'COL')}:{opposite}"


def _correlation(x: Samples, f: Samples) -> float:
    if min(np.ptp(x), np.ptp(f)) == 0.0:
        return 0.0
    return float(np.corrcoef(x, f)[0, 1])


def _by_force(x: Samples, f: Samples) -> int:
    """Which end of the travel has the larger force: 2 or 1 the upper one, 0 unknown, negative."""
    width = _END * float(np.ptp(x))
    low = abs(float(np.median(f[x <= x.min() + width])))
    high = abs(float(np.median(f[x >= x.max() - width])))
    least, most = float(f.min()), float(f.max())
    if min(abs(least), abs(most)) > _ONE_SIDED * max(abs(least), abs(most)) and least * most < 0:
        return 0
    return _vote(high, low)


def _by_slope(x: Samples, f: Samples) -> int:
    """Which third of the travel is stiffer, as in `_by_force`."""
    low_m, third_m = float(x.min()), float(np.ptp(x)) / 3
    low = _slope(x, f, x <= low_m + third_m)
    high = _slope(x, f, x >= low_m + 2 * third_m)
    if low is None or high is None or max(abs(low), abs(high)) == 0.0:
        return 0
    return _vote(abs(high), abs(low))


def _vote(high: float, low: float) -> int:
    larger, smaller = max(high, low), min(high, low)
    size = 2 if larger > _STRONG * smaller else 1 if larger > _CLEAR * smaller else 0
    return size if high > low else -size


def _slope(x: Samples, f: Samples, part: NDArray[np.bool_]) -> float | None:
    off = x[part] - x[part].mean()
    spread = float(off @ off)
    if len(off) < _MIN_SAMPLES or spread == 0.0:
        return None
    return float(off @ f[part]) / spread


def _dissipation(x: Samples, f: Samples) -> tuple[float, int]:
    """Energy that a tool put in over whole loops, and how many loops: 0 where none closes."""
    best: tuple[float, int] = (0.0, 0)
    for level in _LEVELS:
        level_m = float(x.min()) + level * float(np.ptp(x))
        rises = np.flatnonzero((x[:-1] < level_m) & (x[1:] >= level_m))
        rises = (
            rises[np.concatenate(([True], np.diff(rises) > _MIN_SAMPLES))] if len(rises) else rises
        )
        if len(rises) - 1 > best[1]:
            best = _work(x, f, int(rises[0]), int(rises[-1]) + 1), len(rises) - 1
    return best if best[1] else _one_press(x, f)


def _one_press(x: Samples, f: Samples) -> tuple[float, int]:
    """Energy of the way in and out again, above a level near its beginning."""
    start = _END if x[0] - x.min() < x.max() - x[0] else 1.0 - _END
    level_m = float(x.min()) + start * float(np.ptp(x))
    beyond = np.flatnonzero((x > level_m) if start < 0.5 else (x < level_m))
    if not len(beyond) or beyond[0] == 0 or beyond[-1] == len(x) - 1:
        return 0.0, 0
    return _work(x, f, int(beyond[0]) - 1, int(beyond[-1]) + 1), 1


def _work(x: Samples, f: Samples, begin: int, end: int) -> float:
    """Integral of f dx, f from its first value on: what is missing to a closed path is short."""
    steps = np.diff(x[begin : end + 1])
    means = 0.5 * (f[begin:end] + f[begin + 1 : end + 1])
    return float(steps @ (means - f[begin]))


def _energy_text(energy_j: float) -> str:
    for scale, unit in ((1.0, "J"), (1e3, "mJ"), (1e6, "uJ")):
        if energy_j * scale >= 1.0:
            return f"{energy_j * scale:.3g} {unit}"
    return f"{energy_j * 1e9:.3g} nJ"
