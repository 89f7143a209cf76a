"""The quality report of a set of recordings: findings in lines, figures in numbers."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.codegen.errors import DataError
from springpot.codegen.progress import counted
from springpot.trainer.recordings.alignment import Skew, estimate_skew, low_pass_delay_s
from springpot.trainer.recordings.quality.channels import channel_findings, quantisation_step
from springpot.trainer.recordings.quality.coverage import find_coverage
from springpot.trainer.recordings.quality.cycles import Cycles, find_cycles
from springpot.trainer.recordings.quality.finding import Finding, warning
from springpot.trainer.recordings.quality.motion import (
    contact_findings,
    distinct_speeds,
    speed_findings,
)
from springpot.trainer.recordings.quality.noise_floor import noise_floor
from springpot.trainer.recordings.quality.repeats import Repeats, find_repeats, repeat_findings
from springpot.trainer.recordings.quality.signs import find_signs, sign_findings, signs_of_all
from springpot.trainer.recordings.recording import Recording

_FILTERED_RAD = 0.005  # of phase at the recording's frequency: a hard silicone's loss is 0.06


@dataclass(frozen=True)
class QualityReport:
    """Findings and, for each recording and for the set, figures as JSON values."""

    findings: list[Finding]
    recordings: list[dict[str, Any]]
    figures: dict[str, Any]

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
            raise DataError(refusals[0].line.removeprefix("refusal: ") + more)


def check_recordings(recordings: Sequence[Recording]) -> QualityReport:
    """Check each recording by itself, and all together: speeds, repeats, alignment."""
    findings: list[Finding] = []
    cycles = [find_cycles(recording) for recording in counted(recordings, "finding cycles")]
    signs = [find_signs(recording) for recording in recordings]
    for recording, own_cycles, own_signs in zip(recordings, cycles, signs, strict=True):
        findings += channel_findings(recording)
        findings += sign_findings(recording, own_signs)
        findings += contact_findings(recording)
        findings += _filter_findings(recording, own_cycles)
    findings += speed_findings(recordings)
    repeats = find_repeats(recordings)
    findings += repeat_findings(repeats)
    skew = estimate_skew([found for found in cycles if found])
    findings += _skew_findings(recordings, skew)
    details = [
        {**_figures(recording, own_cycles, skew), "signs": own_signs.metadata()}
        for recording, own_cycles, own_signs in zip(recordings, cycles, signs, strict=True)
    ]
    figures = _of_all(recordings, repeats, cycles, skew)
    figures["signs"] = signs_of_all(signs).words
    return QualityReport(findings, details, figures)


def _filter_findings(recording: Recording, cycles: Cycles | None) -> Iterator[Finding]:
    """A filter in the load cell delays force: its phase is not the material's."""
    cutoff_hz = recording.details.get("load_cell_low_pass_hz")
    if cutoff_hz is None:
        return
    order = int(recording.details.get("load_cell_low_pass_order", 1))
    delay_s = _filter_delay_s(recording)
    what = f"the load cell was low-passed at {cutoff_hz:g} Hz, order {order}"
    so_what = f"force comes about {delay_s * 1e3:.3g} ms late"
    if cycles:
        lag_rad = 2 * np.pi * cycles.frequency_hz * delay_s
        if lag_rad < _FILTERED_RAD:
            return
        so_what += f", {lag_rad:.2g} rad at {cycles.frequency_hz:.3g} Hz"
    yield warning(
        "filter", recording.name, what, f"{so_what}: its phase is not the material's",
        f"state it on import, --force-delay-s {delay_s:.4g}, if position is not filtered alike",
    )  # fmt: skip


def _filter_delay_s(recording: Recording) -> float:
    cutoff_hz = recording.details.get("load_cell_low_pass_hz")
    if cutoff_hz is None:
        return 0.0
    order = int(recording.details.get("load_cell_low_pass_order", 1))
    return low_pass_delay_s(order, float(cutoff_hz))


def _skew_findings(recordings: Sequence[Recording], skew: Skew | None) -> Iterator[Finding]:
    if skew is None or abs(skew.delay_s) <= skew.uncertainty_s:
        return
    stated_s = np.mean([r.force_delay_s - r.position_delay_s for r in recordings])
    if abs(skew.delay_s - stated_s) <= skew.uncertainty_s:
        return
    yield warning(
        "alignment", f"all {len(recordings)} recordings",
        f"force seems to come {skew.delay_s * 1e3:.2g} +- {skew.uncertainty_s * 1e3:.2g} ms after "
        "position",
        "loss, and with it stability, would be learned wrong",
        "state the delay on import (--force-delay-s), with --align to take it out",
    )  # fmt: skip


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
    """Loss angle and energy with the alignment's uncertainty, or nothing.

    Taken off is the skew that is stated. Estimated skew gives the uncertainty: without an
    estimate it is not known, and a loss without it would be read as the material's.
    """
    if skew is None:
        return None
    stated_s = recording.force_delay_s - recording.position_delay_s
    doubt_s = abs(skew.delay_s - stated_s) + skew.uncertainty_s
    if stated_s == 0.0:
        doubt_s += _filter_delay_s(recording)
    rate = abs(cycles.skew_rad_per_s)
    lead_rad = cycles.lead_rad + rate * stated_s
    scale = cycles.energy_j / np.sin(cycles.lead_rad) if cycles.lead_rad else 0.0
    return {
        "angle_rad": lead_rad,
        "angle_uncertainty_rad": rate * doubt_s,
        "energy_j": float(scale * np.sin(lead_rad)),
        "energy_uncertainty_j": float(abs(scale) * rate * doubt_s),
    }


def _of_all(
    recordings: Sequence[Recording],
    repeats: Sequence[Repeats],
    cycles: Sequence[Cycles | None],
    skew: Skew | None,
) -> dict[str, Any]:
    floor = noise_floor(repeats, cycles, recordings)
    return {
        "noise_floor_n": None if floor.source == "sensor" else floor.rms_n,
        "sensor_noise_n": floor.rms_n if floor.source == "sensor" else None,
        "noise_floor": floor.words,
        "repeats": [
            {"names": list(g.names), "noise_floor_n": g.noise_n, "drift_n": g.drift_n}
            for g in repeats
        ],
        "distinct_speeds_mps": distinct_speeds(recordings),
        "coverage": find_coverage(recordings).as_dict(),
        "skew_s": skew.delay_s if skew else None,
        "skew_uncertainty_s": skew.uncertainty_s if skew else None,
    }
