"""Figures of recordings: time series, loops, spectra, stiffness and loss against frequency."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from springpot import QualityReport, Recording, UsageError, check_recordings
from springpot.basics import written_aside
from springpot.console import counted
from springpot.figures import ERROR, MUTED, PREDICTED, STYLE, log_ticks, stride

POSITION, FORCE, DOUBT = ERROR, PREDICTED, MUTED
_MAX_POINTS = 6000
_MAX_SHOWN = 12


def time_series(recordings: Sequence[Recording], report: QualityReport) -> Figure:
    """Position and force against time, one recording behind the other."""
    figure = Figure(figsize=(9.0, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    begin_s = 0.0
    for recording in recordings:
        step = stride(len(recording.position_m) * len(recordings), _MAX_POINTS)
        time_s = begin_s + np.arange(len(recording.position_m))[::step] * recording.dt_s
        upper.plot(time_s, recording.position_m[::step] * 1e3, color=POSITION, lw=0.8)
        lower.plot(time_s, recording.force_n[::step], color=FORCE, lw=0.8)
        begin_s += recording.duration_s
        for axes in (upper, lower):
            axes.axvline(begin_s, color=DOUBT, lw=0.4)
    upper.set_ylabel("position, mm")
    lower.set(ylabel="force, N", xlabel="time, s (recordings one behind the other)")
    return figure


def loops(recordings: Sequence[Recording], report: QualityReport) -> Figure:
    """Force against position: a colour a rate, a line style an amplitude."""
    figure = Figure(figsize=(6.4, 4.6), layout="constrained")
    draw_loops(figure.subplots(), recordings, [rate_hz(item) for item in report.recordings])
    return figure


def draw_loops(axes: Axes, recordings: Sequence[Recording], rates: Sequence[float]) -> None:
    """Force against position; rates: of each recording, Hz."""
    travels = [float(np.ptp(recording.position_m)) for recording in recordings]
    distinct = sorted({round(np.log2(travel) * 2) for travel in travels if travel > 0})
    styles = ("-", "--", ":", "-.")
    low, high = min(rates), max(*rates, min(rates) * 1.001)
    for k, (recording, rate, travel) in enumerate(zip(recordings, rates, travels, strict=True)):
        step = stride(len(recording.position_m), _MAX_POINTS)
        share = np.log(rate / low) / np.log(high / low)
        amplitude = distinct.index(round(np.log2(travel) * 2)) if travel > 0 else 0
        axes.plot(
            recording.position_m[::step] * 1e3, recording.force_n[::step], lw=0.8,
            color=mpl.colormaps["viridis"](0.9 * share), ls=styles[amplitude % len(styles)],
            label=f"{rate:.3g} Hz, {travel * 1e3:.3g} mm" if k < _MAX_SHOWN else None,
        )  # fmt: skip
    axes.set(xlabel="position, mm", ylabel="force, N")
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def spectra(recordings: Sequence[Recording], report: QualityReport) -> Figure:
    """Amplitude spectra of position and force."""
    figure = Figure(figsize=(6.4, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for recording in recordings[:_MAX_SHOWN]:
        for axes, samples, scale, colour in (
            (upper, recording.position_m, 1e3, POSITION),
            (lower, recording.force_n, 1.0, FORCE),
        ):
            frequency_hz, amplitude = _amplitudes(samples, recording.dt_s)
            axes.loglog(frequency_hz, amplitude * scale, color=colour, lw=0.6, alpha=0.7)
    for axis in (upper.yaxis, lower.yaxis, lower.xaxis):
        log_ticks(axis)
    upper.set_ylabel("position, mm")
    lower.set(ylabel="force, N", xlabel="frequency, Hz")
    return figure


def dynamics(recordings: Sequence[Recording], report: QualityReport) -> Figure:
    """Stiffness and loss angle of the cyclic recordings; loss only with its uncertainty."""
    figure = Figure(figsize=(6.4, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    cyclic = [metadata["cycles"] for metadata in report.recordings if metadata["cycles"]]
    frequency_hz = [metadata["frequency_hz"] for metadata in cyclic]
    upper.semilogx(frequency_hz, [f["stiffness_npm"] * 1e-3 for f in cyclic], "o", color=POSITION)
    quoted = [metadata for metadata in cyclic if metadata["loss"]]
    if quoted:
        lower.errorbar(
            [metadata["frequency_hz"] for metadata in quoted],
            [metadata["loss"]["angle_rad"] for metadata in quoted],
            yerr=[metadata["loss"]["angle_uncertainty_rad"] for metadata in quoted],
            fmt="o", color=FORCE, ecolor=DOUBT, elinewidth=0.8,
        )  # fmt: skip
    else:
        why = "loss is not quoted: the channels' alignment is not known" if cyclic else "no cycles"
        lower.text(0.5, 0.5, why, ha="center", transform=lower.transAxes, color=DOUBT)
    log_ticks(lower.xaxis)
    upper.set_ylabel("stiffness, N/mm")
    lower.set(
        ylabel="loss angle, rad", xlabel="frequency, Hz (bars: what the alignment leaves open)"
    )
    return figure


FIGURES = {
    "time": time_series, "loops": loops, "spectra": spectra, "dynamics": dynamics,
}  # fmt: skip


def rate_hz(metadata: dict[str, Any]) -> float:
    """Frequency of a recording's cycles, or one over its duration."""
    cycles = metadata["cycles"]
    return float(cycles["frequency_hz"] if cycles else 1.0 / metadata["duration_s"])


def _amplitudes(
    samples: NDArray[np.float64], dt_s: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    window = np.hanning(len(samples))
    spectrum = np.abs(np.fft.rfft((samples - samples.mean()) * window)) * 2.0 / window.sum()
    frequency_hz = np.fft.rfftfreq(len(samples), dt_s)
    # Peaks must survive the thinning: keep the maximum of each group.
    step = stride(len(spectrum), _MAX_POINTS)
    whole = (len(spectrum) - 1) // step * step
    grouped = spectrum[1 : whole + 1].reshape(-1, step)
    kept = np.argmax(grouped, axis=1) + np.arange(len(grouped)) * step + 1
    return frequency_hz[kept], np.maximum(spectrum[kept], 1e-15)


def write_figures(
    folder: Path, recordings: Sequence[Recording], formats: Sequence[str]
) -> list[str]:
    """Write every figure in every format; return the files. Raises UsageError where it cannot."""
    report = check_recordings(recordings)
    files = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with mpl.rc_context(STYLE):
            for name, draw in counted(list(FIGURES.items()), "drawing"):
                figure = draw(recordings, report)
                for form in formats:
                    path = folder / f"{name}.{form}"
                    with written_aside(path) as aside:
                        figure.savefig(aside, format=form, dpi=150)
                    files.append(str(path))
    except OSError as error:
        raise UsageError(f"{folder}: {error.strerror}: choose another --out") from None
    return files
