"""What `springpot material` finds: JSON values, tables and a figure of a fitted springpot."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from springpot import DataError, UsageError
from springpot.basics import Samples, write_file, written_aside
from springpot.figures import ERROR, MEASURED, MUTED, PREDICTED, STYLE, log_ticks, svg_text
from springpot.host.wings.material.law.material import Law, Prony

Dynamic = NDArray[np.complex128]
_LABELS = {"pa": "shear modulus, Pa", "npm": "stiffness, N/m"}
_FREQUENCIES_HZ = np.geomspace(0.1, 100.0, 31)
_NAMED_HZ = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
_TIMES = 61  # of relaxation, as far as the recordings reach


def moduli_figure(
    frequency_hz: Samples,
    law: Dynamic,
    widths: tuple[Samples, Samples] | None,
    prony: Dynamic,
    measured: Sequence[tuple[float, complex]],
    extrapolated: NDArray[np.bool_],
    relaxation: tuple[Samples, Samples],
    unit: str,
    unidentified: Sequence[str],
) -> str:
    """Draw as SVG. law, prony: dynamic values at the frequencies, of which some are extrapolated;
    widths: half the 95 % intervals of the law's storage and loss; measured: frequency and value
    of each cyclic recording; relaxation: times (s), values."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        parts = ((law.real, PREDICTED, "storage"), (law.imag, ERROR, "loss"))
        for k, (values, colour, name) in enumerate(parts):
            if widths is not None:
                low, high = values - widths[k], values + widths[k]
                left.fill_between(frequency_hz, low, high, color=colour, alpha=0.2, lw=0)
            known = np.where(extrapolated, np.nan, values)
            left.loglog(frequency_hz, values, color=colour, lw=0.8, ls=":")
            left.loglog(frequency_hz, known, color=colour, label=f"{name}, law")
        for part, marker in ((np.real, "o"), (np.imag, "s")):
            at = [point[0] for point in measured]
            seen = [float(part(point[1])) for point in measured]
            label = "measured" if part is np.real and measured else None
            left.loglog(at, seen, color=MEASURED, ls="none", marker=marker, ms=4.0, label=label)
        style = {"color": MUTED, "ls": "none", "marker": ".", "ms": 2.5}
        left.loglog(frequency_hz, prony.real, label="Prony series", **style)
        left.loglog(frequency_hz, prony.imag, **style)
        left.set_xlabel("frequency, Hz (dotted: no recording reaches it)")
        left.set_ylabel(_LABELS[unit])
        left.legend(frameon=False, fontsize=7)
        if unidentified:
            figure.text(
                0.5, 0.5, f"not identified: {', '.join(unidentified)}", ha="center", va="center",
                rotation=20, fontsize=22, color=MUTED, alpha=0.5,
            )  # fmt: skip
        right.semilogx(*relaxation, color=PREDICTED)
        for axis in (left.xaxis, left.yaxis, right.xaxis):
            log_ticks(axis)
        right.set_xlabel("time after a step, s")
        right.set_ylabel(f"relaxation, {_LABELS[unit]}")
        return svg_text(figure)


def material_result(
    law: Law, prony: Prony, scale: float | None, accept_unidentified: bool = False
) -> dict[str, Any]:
    """Return keys of `material --json`; moduli (Pa) if a scale (1/m) is known, else stiffness.

    The shear modulus is left out if the recordings do not show it, unless that is accepted.
    """
    by, unit = (1.0, "n_per_m") if scale is None else (scale, "pa")
    dynamic = law.dynamic_npm(_FREQUENCIES_HZ)
    widths = law.dynamic_interval_npm(_FREQUENCIES_HZ)
    low_hz, high_hz = law.covered_hz or _FREQUENCIES_HZ[[0, -1]].tolist()
    band_hz = np.geomspace(low_hz, high_hz, len(_FREQUENCIES_HZ))
    ratio = prony.dynamic_npm(band_hz) / law.dynamic_npm(band_hz)
    named = law.dynamic_npm(np.array(_NAMED_HZ))
    result: dict[str, Any] = {
        "stiffness_npm": law.stiffness_npm,
        "coefficient": law.coefficient,
        "order": law.order,
        "instant_npm": law.instant_npm,
        "time_s": law.time_s,
        "intervals_95": dict(law.intervals),
        "not_identified": dict(law.not_identified),
        "residual_percent": law.residual_percent,
        "covered_hz": law.covered_hz,
        "measured": [
            {
                "frequency_hz": point["frequency_hz"],
                "storage": by * point["storage_npm"],
                "loss": by * point["loss_npm"],
            }
            for point in law.measured
        ],
        "unit": unit,
        "frequency_hz": _FREQUENCIES_HZ.tolist(),
        "extrapolated": extrapolated(law).tolist(),
        "storage": (by * dynamic.real).tolist(),
        "loss": (by * dynamic.imag).tolist(),
        "storage_interval_95": None if widths is None else (by * widths[0]).tolist(),
        "loss_interval_95": None if widths is None else (by * widths[1]).tolist(),
        "loss_factor": {
            f"{hz:g}": float(value.imag / value.real)
            for hz, value in zip(_NAMED_HZ, named, strict=True)
        },
        "prony": {
            "long_term": by * prony.long_term_npm,
            "instant": by * prony.instant_npm,
            "tau_s": prony.tau_s.tolist(),
            "share": (prony.branch_npm / prony.instant_npm).tolist(),
            "max_error": float(np.max(np.abs(ratio - 1.0))),
        },
    }
    width_npm = law.intervals["stiffness_npm"]
    if scale is not None and (width_npm is not None or accept_unidentified):
        result["shear_modulus_pa"] = scale * law.stiffness_npm
        result["shear_modulus_interval_pa"] = None if width_npm is None else scale * width_npm
    return result


def extrapolated(law: Law) -> NDArray[np.bool_]:
    """Return whether no recording reaches a frequency of the table: (frequencies,)."""
    low_hz, high_hz = law.covered_hz or (0.0, np.inf)
    beyond: NDArray[np.bool_] = (low_hz > _FREQUENCIES_HZ) | (high_hz < _FREQUENCIES_HZ)
    return beyond


def require_identified(law: Law) -> None:
    """Raise DataError where the recordings do not show a number of the law."""
    for name, why in law.not_identified.items():
        raise DataError(
            f"no table or figure of a law that is not identified: {name}: {why}; or accept it, "
            "--accept-unidentified, and the figure says so"
        )


def require_prony(result: dict[str, Any], limit: float) -> None:
    """Raise DataError where the Prony series misses the law by more than a share."""
    error = result["prony"]["max_error"]
    if error > limit:
        raise DataError(
            f"the Prony series misses the law by {100 * error:.2g} % at frequencies that were "
            f"recorded: record at a higher rate, or accept it, --prony-error {100 * error:.0f}%"
        )


def write_material(out: Path, law: Law, prony: Prony, scale: float | None) -> list[str]:
    """Write moduli.csv, relaxation.csv, prony.csv and moduli.svg; return their names."""
    by, unit = (1.0, "npm") if scale is None else (scale, "pa")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out}: {error.strerror}: give a folder for --out") from None
    dynamic = by * law.dynamic_npm(_FREQUENCIES_HZ)
    beyond = extrapolated(law)
    columns = [_FREQUENCIES_HZ, dynamic.real, dynamic.imag, beyond]
    header = ["frequency_hz", f"storage_{unit}", f"loss_{unit}", "extrapolated"]
    widths = law.dynamic_interval_npm(_FREQUENCIES_HZ)
    if widths is not None:
        columns += [by * width for width in widths]
        header += [f"storage_interval_95_{unit}", f"loss_interval_95_{unit}"]
    _table(out / "moduli.csv", header, columns)
    low_hz, high_hz = law.covered_hz or _FREQUENCIES_HZ[[0, -1]].tolist()
    time_s = np.geomspace(0.1 / high_hz, 1.0 / low_hz, _TIMES)
    relaxing = by * law.relaxing_npm(time_s)
    _table(out / "relaxation.csv", ["time_s", f"relaxation_{unit}"], [time_s, relaxing])
    # The order of columns that finite-element programs read: shear share, bulk share, time.
    shares = prony.branch_npm / prony.instant_npm
    header = ["shear_share", "bulk_share", "tau_s"]
    _table(out / "prony.csv", header, [shares, np.zeros_like(shares), prony.tau_s])
    discretised = by * prony.dynamic_npm(_FREQUENCIES_HZ)
    measured = [
        (point["frequency_hz"], by * complex(point["storage_npm"], point["loss_npm"]))
        for point in law.measured
    ]
    figure = moduli_figure(
        _FREQUENCIES_HZ,
        dynamic,
        None if widths is None else (by * widths[0], by * widths[1]),
        discretised,
        measured,
        beyond,
        (time_s, relaxing),
        unit,
        tuple(law.not_identified),
    )
    write_file(out / "moduli.svg", figure.encode())
    return ["moduli.csv", "relaxation.csv", "prony.csv", "moduli.svg"]


def _table(file: Path, header: Sequence[str], columns: Sequence[Any]) -> None:
    with written_aside(file) as aside, aside.open("w", newline="") as text:
        writer = csv.writer(text)
        writer.writerow(header)
        writer.writerows(np.stack(columns, axis=1).tolist())
