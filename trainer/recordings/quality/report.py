"""The quality report of a set of recordings: findings in lines, figures in numbers.

Of all together: whether force begins at position 0, where the surface should be, and is 0 without
contact.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.messages import with_progress
from springpot.codegen.types import JsonObject
from springpot.trainer.recordings.conditioning import (
    Conditioning,
    align_surfaces,
    condition,
    find_air_drift,
)
from springpot.trainer.recordings.contact_point import ContactPoint, find_contact
from springpot.trainer.recordings.formats.units import format_map_option, split_factor
from springpot.trainer.recordings.quality.channels import channel_findings, level_findings
from springpot.trainer.recordings.quality.finding import Finding, join_refusals, refusal, warning
from springpot.trainer.recordings.quality.loops import (
    Dissipation,
    format_lateness,
    lateness_findings,
)
from springpot.trainer.recordings.quality.repeats import (
    Cycles,
    Skew,
    estimate_skew,
    find_cycles,
    find_noise_floor,
    find_repeats,
    skew_findings,
)
from springpot.trainer.recordings.quality.signs import Signs, find_signs, sign_findings
from springpot.trainer.recordings.quality.spikes import replace_spikes
from springpot.trainer.recordings.quality.units import summarise_press, unit_findings
from springpot.trainer.recordings.recording import Recording, Zero
from springpot.trainer.recordings.recording_file import Recordings, resolve_recordings

_MAX_OFFSET_FRACTION, _MIN_TARE_FRACTION = 0.05, 0.02  # of the travel; of the peak force
_MIN_LOAD_FRACTION, _LOAD_TOLERANCE = (
    0.25,
    0.25,
)  # of the peak force; of itself: tares that differ by less are one
_MAX_UNCERTAINTY_FRACTION = 0.1  # of the deepest press: force errs by 5 to 10 % of its peak

_COMPARED_LEVELS, _MOVED_RATIO = 10, 0.7  # of the depth; of the difference that a shift leaves
_ALSO_TORN = ("gone", "fall")  # a force that is torn, late or turned round is also so
# Remedies, as a person types them, and what they do.
_BY_CONTACT: dict[str, tuple[Conditioning, Zero]] = {
    "import with --contact-force auto": (Conditioning(contact_force="auto"), "none")
}
_BY_TARE: dict[str, tuple[Conditioning, Zero]] = {
    "import with --tare auto": (Conditioning(tare="auto"), "none")
}
_BY_ZERO: dict[str, tuple[Conditioning, Zero]] = {
    "import with --zero first": (Conditioning(), "first"),
    "import with --zero min": (Conditioning(), "min"),
}
RecordingContact = tuple[Recording, ContactPoint]


@dataclass(frozen=True, eq=False)
class QualityReport:
    """Findings of a set of recordings; figures, as JSON values, are computed when they are read.

    checked: the recordings without spikes. cycles, signs: of each. skew: of the set.

    >>> check_recordings(recordings)
    QualityReport(3 recordings, findings: none)
    """

    checked: list[Recording]
    findings: list[Finding]
    cycles: Sequence[Cycles | None]
    signs: Sequence[Signs]
    skew: Skew | None

    def __repr__(self) -> str:
        kinds = ", ".join(dict.fromkeys(finding.kind for finding in self.findings)) or "none"
        return f"QualityReport({len(self.checked)} recordings, findings: {kinds})"

    @cached_property
    def recordings(self) -> list[JsonObject]:
        """Figures of each recording."""
        figures = zip(self.checked, self.cycles, self.signs, strict=True)
        return [_compute_figures(*parts, self.skew) for parts in figures]

    @cached_property
    def figures(self) -> JsonObject:
        """Figures of the set."""
        floor = find_noise_floor(self.checked, self.cycles)
        return {
            "noise_floor_n": None if floor.source == "sensor" else floor.rms_n,
            "sensor_noise_n": floor.rms_n if floor.source == "sensor" else None,
            "noise_floor": floor.words,
            "repeats": [
                [recording.name for recording in group] for group in find_repeats(self.checked)
            ],
            "skew_s": self.skew.delay_s if self.skew else None,
            "skew_uncertainty_s": self.skew.uncertainty_s if self.skew else None,
            "signs": self.sign_words,
        }

    @property
    def sign_words(self) -> str:
        """Which way the channels point by the strongest evidence, and the loops of all."""
        energies_j = sum(signs.dissipation.energy_j for signs in self.signs)
        lost = Dissipation(energies_j, sum(signs.dissipation.loops for signs in self.signs))
        strongest = max(self.signs, key=lambda signs: signs.evidence)
        return replace(strongest, dissipation=lost).words + format_lateness(self.checked)

    @property
    def refused(self) -> bool:
        """Return whether some finding says that no model can be made of this."""
        return _has_refusal(self.findings)

    def as_dict(self) -> JsonObject:
        """Keys of `check --json`."""
        findings = [finding.metadata() for finding in self.findings]
        lists = {"findings": findings, "recordings": self.recordings}
        return {"refused": self.refused, **lists, **self.figures}

    def refuse(self) -> None:
        """Raise DataError with all refusals, if any."""
        refusals = [finding.text for finding in self.findings if finding.severity == "refusal"]
        if refusals:
            raise join_refusals(refusals)


def check_recordings(given: Recordings) -> QualityReport:
    """Check each recording by itself, and all together: contact, repeats, alignment.

    >>> check_recordings(recordings).refused
    False
    """
    findings: list[Finding] = []
    checked, signs, cycles, intact = [], [], [], []
    for read in with_progress(resolve_recordings(given), "checking"):
        recording, faults = read, list(level_findings(read))
        if not faults:
            recording, faults = replace_spikes(read)
            faults += channel_findings(recording)
        checked.append(recording)
        signs.append(find_signs(recording))
        cycles.append(find_cycles(recording))
        if not _has_refusal(
            faults
        ):  # one cause, one line: a constant has no unit, a wrap turns signs
            # A sensor that stands still seems to drift, and to give energy; a force that is torn
            # or late is missed on the next way in.
            stuck = any(finding.kind == "stuck" for finding in faults)
            stands = stuck or any(finding.kind == "clipping" for finding in faults)
            sign_faults = list(sign_findings(recording, signs[-1]))
            sign_faults = [
                finding
                for finding in sign_faults
                if not (stuck and finding.kind == "energy")
                and not (stands and finding.kind == "exchanged")
            ]
            faults = [
                finding for finding in faults if not (sign_faults and finding.kind in _ALSO_TORN)
            ] + sign_faults
            spoiled = _has_refusal(faults) or stuck  # a turned sign moves the contact
            faults += [] if spoiled else _depth_findings(recording)
            intact += [] if _has_refusal(faults) or spoiled else [recording]
            faults += unit_findings(recording)
        findings += faults
    findings += _compare_units(intact)
    skew = estimate_skew([cycle for cycle in cycles if cycle])
    late = list(skew_findings(checked, skew)) or lateness_findings(intact)
    findings += [*contact_findings(intact), *late]
    return QualityReport(checked, findings, cycles, signs, skew)


@dataclass(frozen=True)
class SetUnitRule:
    """When one recording of a set is in another unit.

    ratio: times the others' force at equal depth, in the deeper half of what all reach, or their
    stroke: objects and depths of one set differ by less. alike: of the other channel, by which it
    differs at most.
    """

    ratio: float = 30.0
    alike: float = 5.0


_SET_UNITS = SetUnitRule()


def _compare_units(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Refuse a recording whose stroke or force is many times that of the others."""
    if len(recordings) < 2:
        return
    strokes_m = np.array([float(np.ptp(recording.position_m)) for recording in recordings])
    peaks_n = np.array([float(np.ptp(recording.force_n)) for recording in recordings])
    common_m = min(float(recording.position_m.max()) for recording in recordings)
    if common_m <= 0.0:
        return
    forces_n = np.array([
        float(np.median(np.abs(recording.force_n[deep]))) if deep.any() else 0.0
        for recording in recordings
        for deep in [np.abs(recording.position_m / common_m - 0.75) <= 0.25]
    ])  # fmt: skip
    for channel, sizes, peaks, others in (
        ("position", strokes_m, strokes_m, peaks_n),
        ("force", forces_n, peaks_n, strokes_m),
    ):
        usual, highest, beside = (float(np.median(values[:-1] if len(values) == 2 else values))
                                  for values in (sizes, peaks, others))  # fmt: skip
        if not (highest and beside):  # of what never moves or pushes its own finding says so
            continue
        for recording, size, peak, other in zip(recordings, sizes, peaks, others, strict=True):
            alike = 1.0 / _SET_UNITS.alike < other / beside < _SET_UNITS.alike
            ratio = float(size) / usual if usual else 0.0
            many = bool(ratio) and max(ratio, 1.0 / ratio) > _SET_UNITS.ratio
            # An object that is still deep from the press before has hardly any force at equal
            # depth, but the same peak: of another unit the peak is off as well.
            peak_ratio = float(peak) / highest
            same_way = (
                (peak_ratio > _SET_UNITS.alike)
                if ratio > 1.0
                else (peak_ratio * _SET_UNITS.alike < 1.0)
            )
            if many and alike and same_way:
                read = recording.details.get("units", {}).get(channel, {})
                stated = read.get("unit") or {"position": "m", "force": "N"}[channel]
                factor, unit = split_factor(stated)
                mended = f"{factor * 10.0 ** -round(float(np.log10(ratio))):.6g}{unit}"
                option = format_map_option(channel, read.get("column", "COL"), mended)
                at = "at equal depth" if channel == "force" else "at equal force"
                yield refusal(
                    "unit", recording.name,
                    f"{channel} is {ratio:.3g} times that of the others {at}",
                    "its unit is another, or it is of another object",
                    f"import it apart, {option} if so, or leave it out",
                )  # fmt: skip


def _first_that_mends(
    recordings: Sequence[Recording], remedies: Mapping[str, tuple[Conditioning, Zero]]
) -> str:
    """Return the first remedy that ends right when it is followed on these recordings; else none.

    Followed in memory. Right is: not refused, by its signs neither, and at most as far off as the
    surface is known.
    """
    for words, (options, zero) in remedies.items():
        with suppress(DataError, UsageError):
            mended = [condition(recording, options, zero)[0] for recording in recordings]
            align_surfaces(mended, options)
            judged = [
                finding
                for recording in mended
                for finding in sign_findings(recording, find_signs(recording))
            ]
            deep = all(float(recording.position_m.max()) > 0.0 for recording in mended)
            if deep and not _has_refusal(judged):
                return words
    return "no option mends that: record from farther above the object, or correct the source"


def _depth_findings(recording: Recording) -> Iterator[Finding]:
    """Refuse positions that are never above 0, as those of a gap meter turned round."""
    position_m = recording.position_m
    if recording.zero == "none" and position_m.max() <= 0.0 < np.ptp(position_m):
        to_do = _first_that_mends([recording], {**_BY_CONTACT, **_BY_ZERO})
        yield refusal(
            "contact", recording.name,
            f"position is below 0 all along, {1e3 * position_m.min():.4g} to "
            f"{1e3 * position_m.max():.4g} mm", "nothing would be pressed", to_do,
        )  # fmt: skip


def _has_refusal(findings: Sequence[Finding]) -> bool:
    return any(finding.severity == "refusal" for finding in findings)


def _compute_figures(
    recording: Recording, cycles: Cycles | None, signs: Signs, skew: Skew | None
) -> JsonObject:
    """Return the figures of a recording for `check --json`: ranges, signs, cycles, loss angle."""
    position_m, force_n = recording.position_m, recording.force_n
    place = {"place_m": list(recording.place_m)} if recording.place_m else {}
    return place | {
        "name": recording.name,
        "samples": len(position_m),
        "rate_hz": recording.rate_hz,
        "duration_s": recording.duration_s,
        "position_m": [float(position_m.min()), float(position_m.max())],
        "force_n": [float(force_n.min()), float(force_n.max())],
        "max_speed_mps": summarise_press(recording).speed_mps,
        "zero": recording.zero,
        "signs": signs.metadata(),
        "cycles": cycles and cycles.metadata() | {"loss": skew and skew.loss(recording, cycles)},
    }


def contact_findings(recordings: Sequence[Recording]) -> Iterator[Finding]:
    """Yield findings where position 0 should be the surface and is not, of all together."""
    contacts: list[RecordingContact] = []
    for recording in recordings:
        if steadied := find_air_drift(recording):
            drift = steadied[1]
            yield warning(
                "drift", recording.name,
                f"force without contact drifts by {60.0 * drift.slope_nps:.3g} +- "
                f"{60.0 * drift.bound_nps:.2g} N/min", "the model would learn it as the object's",
                _first_that_mends([recording], _BY_TARE),
            )  # fmt: skip
        uncertainty_m = recording.details.get("contact_uncertainty_m")
        if uncertainty_m and uncertainty_m > _MAX_UNCERTAINTY_FRACTION * recording.position_m.max():
            yield warning(
                "contact", recording.name,
                f"its surface is known to +- {1e3 * uncertainty_m:.2g} mm of "
                f"{1e3 * recording.position_m.max():.3g} mm pressed",
                "the force of a light press may err by its whole size",
                "press more slowly at first, or with less noise of the force",
            )  # fmt: skip
    for recording in (recording for recording in recordings if recording.zero == "none"):
        with suppress(DataError):  # a tool that never leaves the object shows no surface
            contacts.append((recording, find_contact(recording)))
    # An object that remembers its last press is met where that left it.
    yield from _surface_findings([item for item in contacts if not item[0].start_s])
    tares = [
        (recording, contact.tare_n)
        for recording, contact in contacts
        if abs(contact.tare_n)
        > max(contact.threshold_n, _MIN_TARE_FRACTION * recording.force_n.max())
    ]
    loads_n = [
        tare_n
        for recording, tare_n in tares
        if abs(tare_n) > _MIN_LOAD_FRACTION * recording.force_n.max()
    ]
    all_loaded = 0 < len(loads_n) == len(recordings)
    shared = all_loaded and np.ptp(loads_n) < _LOAD_TOLERANCE * np.abs(loads_n).max()
    for recording, tare_n in tares:
        finding = refusal if shared and "tare_n" not in recording.details else warning
        yield finding(
            "tare", recording.name, f"{tare_n:.3g} N without contact",
            "the model would push or pull where nothing is touched",
            "import with --tare auto, or with --tare 0 if the object pushes so there",
        )  # fmt: skip


def _surface_findings(met: Sequence[RecordingContact]) -> Iterator[Finding]:
    """Distinguish a zero that is not the surface from an object that is still dented.

    An object that has not recovered is met deeper, never less deep: where one recording begins at
    position 0, others that begin deeper do not say that the surface is elsewhere. To put each of
    them at 0 would take away what the object remembers.
    """
    sure = any(_is_displaced(*item, bounds=2.0) for item in met)
    agree = len(met) > 1 and all(_is_displaced(*item, bounds=1.0) for item in met)
    if not sure and not agree:
        return
    off = [item for item in met if _is_displaced(*item, bounds=0.0)]
    first = min(met, key=lambda item: item[1].position_m)
    where = off[0][0].name if len(off) == 1 else f"{len(off)} recordings"
    usual_m = float(np.median([contact.position_m for _, contact in off]))
    begins = f"force begins at {1e3 * usual_m:.3g} mm"
    if first in off:
        yield warning(
            "contact", where, f"{begins}, not at 0", "the surface is not where position is 0",
            _first_that_mends([recording for recording, _ in off], _BY_CONTACT),
        )  # fmt: skip
    elif moved := [item for item in off if _is_moved_throughout(*item, first[0])]:
        where = moved[0][0].name if len(moved) == 1 else f"{len(moved)} recordings"
        yield warning(
            "contact", where, f"{begins}, in {first[0].name} at 0",
            "the object had not recovered there, or its zero was another",
            "import with --rest-s if one object was pressed in this order, with --contact-force "
            "auto if each recording has a zero of its own",
        )  # fmt: skip


def _is_moved_throughout(recording: Recording, contact: ContactPoint, other: Recording) -> bool:
    """Return whether a recording is more like another if it is moved to begin at 0.

    Of a press that follows the last one soon, the first contact alone is late: memory of the object
    that any model has, and no reason for a word.
    """
    deepest_m = min(float(recording.position_m.max()) - contact.position_m,
                    float(other.position_m.max()))  # fmt: skip
    levels_m = np.linspace(0.0, deepest_m, _COMPARED_LEVELS + 1)
    own_n, moved_n, other_n = (
        _loading_force_n(pressed.position_m - shift_m, pressed.force_n, levels_m)
        for pressed, shift_m in ((recording, 0.0), (recording, contact.position_m), (other, 0.0))
    )
    seen = np.isfinite(own_n + moved_n + other_n)
    if not seen.any():
        return False
    off_n, off_moved_n = rms((own_n - other_n)[seen]), rms((moved_n - other_n)[seen])
    return bool(off_moved_n < _MOVED_RATIO * off_n)


def _loading_force_n(position_m: Samples, force_n: Samples, levels_m: Samples) -> Samples:
    """Mean force on the way in between levels, (levels - 1,), N; nan where the tool never was."""
    inwards = np.gradient(position_m) > 0.0
    place = np.digitize(position_m, levels_m) - 1
    return np.array([
        force_n[inwards & (place == level)].mean() if (inwards & (place == level)).any() else np.nan
        for level in range(len(levels_m) - 1)
    ])  # fmt: skip


def _is_displaced(recording: Recording, contact: ContactPoint, bounds: float) -> bool:
    allowed_m = (
        _MAX_OFFSET_FRACTION * float(np.ptp(recording.position_m)) + bounds * contact.uncertainty_m
    )
    return abs(contact.position_m) > allowed_m
