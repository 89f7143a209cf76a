"""The quality report of a set of recordings: findings in lines, figures in numbers."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.codegen.progress import counted
from springpot.trainer.recordings.quality.alignment import (
    STEADY,
    Skew,
    estimate_skew,
    filter_delay_s,
    filter_findings,
    skew_findings,
)
from springpot.trainer.recordings.quality.contact.surface import contact_findings
from springpot.trainer.recordings.quality.cycles import Cycles, find_cycles
from springpot.trainer.recordings.quality.finding import Finding
from springpot.trainer.recordings.quality.motion import (
    distinct_speeds,
    speed_findings,
)
from springpot.trainer.recordings.quality.noise_floor import noise_floor
from springpot.trainer.recordings.quality.places import place_findings
from springpot.trainer.recordings.quality.repeats import Repeats, find_repeats, repeat_findings
from springpot.trainer.recordings.quality.scales import scale_findings
from springpot.trainer.recordings.quality.sensors.channels import (
    channel_findings,
    quantisation_step,
)
from springpot.trainer.recordings.quality.sensors.play import play_findings
from springpot.trainer.recordings.quality.signs import (
    Signs,
    find_signs,
    sign_findings,
    signs_of_all,
)
from springpot.trainer.recordings.quality.snap import snap_findings
from springpot.trainer.recordings.quality.spikes import hold_spikes
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import Recordings, given_recordings


@dataclass(frozen=True, eq=False)
class QualityReport:
    """Findings of a set of recordings; figures, as JSON values, are computed when they are read.

    given: the recordings as they were read; checked: without spikes. cycles, signs: of each.
    repeats, skew: of the set.

    >>> check_recordings(recordings)
    QualityReport(3 recordings, findings: none)
    """

    given: Sequence[Recording]
    checked: Sequence[Recording]
    findings: list[Finding]
    cycles: Sequence[Cycles | None]
    signs: Sequence[Signs]
    repeats: Sequence[Repeats]
    skew: Skew | None

    def __repr__(self) -> str:
        kinds = ", ".join(dict.fromkeys(finding.kind for finding in self.findings)) or "none"
        return f"QualityReport({len(self.checked)} recordings, findings: {kinds})"

    @cached_property
    def recordings(self) -> list[dict[str, Any]]:
        """Figures of each recording."""
        return [
            {
                **_figures(recording, own_cycles, self.skew),
                "signs": own_signs.metadata(),
            }
            for recording, own_cycles, own_signs in zip(
                self.checked, self.cycles, self.signs, strict=True
            )
        ]

    @cached_property
    def figures(self) -> dict[str, Any]:
        """Figures of the set."""
        presses = self.checked
        floor = noise_floor(self.repeats, self.cycles, self.checked)
        return {
            "noise_floor_n": None if floor.source == "sensor" else floor.rms_n,
            "sensor_noise_n": floor.rms_n if floor.source == "sensor" else None,
            "noise_floor": floor.words,
            "repeats": [
                {"names": list(g.names), "noise_floor_n": g.noise_n, "drift_n": g.drift_n}
                for g in self.repeats
            ],
            "distinct_speeds_mps": distinct_speeds(presses),
            "skew_s": self.skew.delay_s if self.skew else None,
            "skew_uncertainty_s": self.skew.uncertainty_s if self.skew else None,
            "signs": self.sign_words,
        }

    @property
    def sign_words(self) -> str:
        """Which way the channels point, in one line."""
        return signs_of_all(self.signs).words

    @property
    def refused(self) -> bool:
        """Whether some finding says that no model can be made of this."""
        return any(finding.severity == "refusal" for finding in self.findings)

    def as_dict(self) -> dict[str, Any]:
        """Keys of `check --json`."""
        return {
            "refused": self.refused,
            "findings": [finding.metadata() for finding in self.findings],
            "recordings": self.recordings,
            **self.figures,
        }

    def refuse(self) -> None:
        """Raise DataError for the first refusal, if any, counting the others."""
        refusals = [finding for finding in self.findings if finding.severity == "refusal"]
        if refusals:
            more = f" ({len(refusals) - 1} more)" if len(refusals) > 1 else ""
            raise DataError(refusals[0].text + more)


def check_recordings(given: Recordings) -> QualityReport:
    """Check each recording by itself, and all together: speeds, repeats, alignment.

    >>> check_recordings(recordings).refused
    False
    """
    findings: list[Finding] = []
    whole, recordings = given_recordings(given), []
    for recording in whole:  # what follows is judged without spikes, as a fit does
        held, spikes = hold_spikes(recording)
        recordings.append(held)
        findings += spikes
    cycles = [find_cycles(recording) for recording in counted(recordings, "finding cycles")]
    signs = [find_signs(recording) for recording in recordings]
    touched: list[Recording] = []
    for recording, own_signs in zip(recordings, signs, strict=True):
        of_channels = list(channel_findings(recording))
        # One cause, one line: a wrap turns signs, a turned sign moves the contact.
        wraps = any(finding.kind == "wrap" for finding in of_channels)
        of_signs = [] if wraps else list(sign_findings(recording, own_signs))
        findings += of_channels + of_signs
        findings += [] if of_signs else play_findings(recording)
        exchanged = any(finding.kind == "exchanged" for finding in of_signs)
        refused = any(finding.severity == "refusal" for finding in of_signs)
        if not (wraps or exchanged or refused):
            touched.append(recording)
    presses = recordings
    findings += contact_findings(touched)
    refused = any(f.severity == "refusal" for f in findings)  # a turned sign falls, too
    findings += [] if refused else [*snap_findings(presses), *scale_findings(presses)]
    findings += speed_findings(presses) if presses else []
    repeats = find_repeats(presses)
    findings += place_findings(recordings, repeats)
    findings += repeat_findings(repeats)
    skew = estimate_skew([found for found in cycles if found])
    findings += filter_findings(recordings, cycles, skew)
    findings += skew_findings(presses, skew)
    return QualityReport(whole, recordings, findings, cycles, signs, repeats, skew)


def _figures(recording: Recording, cycles: Cycles | None, skew: Skew | None) -> dict[str, Any]:
    position_m, force_n = recording.position_m, recording.force_n
    figures: dict[str, Any] = {
        "name": recording.name,
        "samples": len(position_m),
        "rate_hz": recording.rate_hz,
        "duration_s": recording.duration_s,
        "position_m": [float(position_m.min()), float(position_m.max())],
        "force_n": [float(force_n.min()), float(force_n.max())],
        "max_speed_mps": float(np.abs(np.diff(position_m)).max()) / recording.dt_s,
        "position_step_m": quantisation_step(position_m),
        "force_step_n": quantisation_step(force_n),
        "jitter_rms_s": recording.details.get("sampling", {}).get("jitter_rms_s"),
        "zero": recording.zero,
        "position_delay_s": recording.position_delay_s,
        "force_delay_s": recording.force_delay_s,
        "cycles": None,
    }
    if recording.place_m:
        figures["place_m"] = list(recording.place_m)
    if cycles:
        figures["cycles"] = {
            "frequency_hz": cycles.frequency_hz,
            "count": cycles.count,
            "amplitude_m": cycles.amplitude_m,
            "stiffness_npm": cycles.stiffness_npm,
            "noise_floor_n": cycles.noise_n,
            "drift_n": cycles.drift_n,
            "loss": _loss(recording, cycles, skew),
        }
    return figures


def _loss(recording: Recording, cycles: Cycles, skew: Skew | None) -> dict[str, float] | None:
    """Loss angle and energy with the alignment's uncertainty, or nothing: of steady cycles only.

    Taken off is the skew that is stated. Estimated skew gives the uncertainty: without an
    estimate it is not known, and a loss without it would be read as the material's.
    """
    if skew is None or cycles.count < STEADY:
        return None
    stated_s = recording.force_delay_s - recording.position_delay_s
    doubt_s = abs(skew.delay_s - stated_s) + skew.uncertainty_s
    if stated_s == 0.0:
        doubt_s += filter_delay_s(recording, skew)
    rate = abs(cycles.skew_rad_per_s)
    lead_rad = cycles.lead_rad + rate * stated_s
    scale = cycles.energy_j / np.sin(cycles.lead_rad) if cycles.lead_rad else 0.0
    return {
        "angle_rad": lead_rad,
        "angle_uncertainty_rad": rate * doubt_s,
        "energy_j": float(scale * np.sin(lead_rad)),
        "energy_uncertainty_j": float(abs(scale) * rate * doubt_s),
    }
