"""Tables and pictures of what Python calls return: `.plot()`, and what a notebook shows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from html import escape
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from springpot import (
    Emission,
    Fit,
    QualityReport,
    Recording,
    Stability,
    UsageError,
    Validation,
    check_recordings,
)
from springpot.console import (
    TextTable,
    check_parts,
    emission_rows,
    stability_rows,
    training_result,
    training_rows,
    validation_rows,
)
from springpot.loop import NOTE_WORDS
from springpot.modelling import limited_n, model_hash, zero_of
from springpot.validation import series_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MISSING = "needs matplotlib: pip install 'springpot[report]'"
_MAX_SAMPLES = 20_000  # of a press that is drawn
_MAX_POINTS, _MIN_POINTS = 2000, 60  # of a small picture, of each curve in it


def plotted(found: object, axes: "Axes | None") -> "Axes":
    """Draw a result on axes, on new ones of pyplot if none are given. Raises UsageError."""
    if find_spec("matplotlib") is None:
        raise UsageError(f".plot() {_MISSING}")
    from matplotlib import pyplot, rc_context

    from springpot.figures import STYLE

    with rc_context(STYLE):
        if axes is None:
            axes = pyplot.subplots(layout="constrained")[1]
        _faces(found)[1](found, axes)
    return axes


def html(found: object) -> str:
    """The table that the command line prints, and a small picture where matplotlib is there."""
    table = "".join(map(_html_part, _faces(found)[0](found)))
    if find_spec("matplotlib") is None or (isinstance(found, Emission) and found.check is None):
        return table
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from springpot.figures import STYLE, stride, svg_text

    with rc_context({**STYLE, "svg.fonttype": "none"}):
        figure = Figure(figsize=(4.6, 2.8), layout="constrained")
        axes = figure.subplots()
        _faces(found)[1](found, axes)
        curves = [np.asarray(line.get_xydata()) for line in axes.lines]
        for line, points in zip(axes.lines, curves, strict=True):  # each point takes ten letters
            step = min(stride(sum(map(len, curves)), _MAX_POINTS), stride(len(points), _MIN_POINTS))
            line.set_data(*points[::step].T)
        return table + svg_text(figure)


def _faces(
    found: object,
) -> tuple[Callable[[Any], Iterable[str | TextTable]], Callable[[Any, "Axes"], None]]:
    """What lists a result in lines and tables, and what draws it."""
    return next(faces for kind, faces in _FACES.items() if isinstance(found, kind))


def _html_part(part: str | TextTable) -> str:
    if isinstance(part, str):
        return f"<div>{escape(part)}</div>"
    columns, rows = part
    head = [_html_row(columns, "th")] if any(columns) else []
    return f"<table>{''.join([*head, *(_html_row(row, 'td') for row in rows)])}</table>"


def _html_row(cells: Sequence[str], tag: str) -> str:
    shown = (f"<{tag} style='text-align:left'>{escape(cell)}</{tag}>" for cell in cells)
    return f"<tr>{''.join(shown)}</tr>"


def _of(rows: Mapping[str, str]) -> list[str | TextTable]:
    return [(("", ""), list(rows.items()))]


def _recording_parts(recording: Recording) -> list[str | TextTable]:
    """Its row in the table of `springpot check`."""
    return [next(iter(check_parts(_checked(recording))))]


@lru_cache(maxsize=4)  # the table and the picture are of one check
def _checked(recording: Recording) -> QualityReport:
    return check_recordings(recording)


def _fit_parts(fit: Fit) -> list[str | TextTable]:
    result = training_result(fit) | {"hash": model_hash(fit.model)}
    return [*_of(training_rows(fit, result)), *(f"warning: {line}" for line in fit.warnings)]


def _draw_recordings(report: QualityReport, axes: "Axes") -> None:
    from springpot.host.wings.report.recording_figures import draw_loops, rate_hz

    draw_loops(axes, report.checked, [rate_hz(item) for item in report.recordings])


def _draw_recording(recording: Recording, axes: "Axes") -> None:
    """A loop; of a session's log, dots where the C said something of the tick too."""
    _draw_recordings(_checked(recording), axes)
    if "notes" not in recording.channels:
        return
    notes = recording.channels["notes"].astype(int)
    for bit, words in NOTE_WORDS.items():
        noted = (notes & bit) != 0
        if noted.any():
            depth_mm = 1e3 * recording.position_m[noted]
            axes.plot(depth_mm, recording.force_n[noted], ".", ms=3, label=words)
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def _draw_fit(fit: Fit, axes: "Axes") -> None:
    """Force of the model in a press of the trained depth, as fast as was recorded and slower."""
    from springpot.figures import ERROR, PREDICTED

    model, trained = fit.model, fit.model.trained
    low_m = trained.min_m if model.contact == "always" else 0.0
    for share, colour in ((1.0, ERROR), (0.1, PREDICTED)):
        # A raised cosine's greatest speed is pi times its height over its period.
        period_s = np.pi * (trained.max_m - low_m) / (share * trained.max_mps)
        phase = np.linspace(0.0, 2.0 * np.pi, min(round(period_s / model.dt_s) + 2, _MAX_SAMPLES))
        depth_m = low_m + (trained.max_m - low_m) * (1.0 - np.cos(phase)) / 2.0
        press = Recording("press", depth_m, 0.0 * depth_m, model.dt_s, zero_of(model))
        label = f"up to {1e3 * share * trained.max_mps:.3g} mm/s"
        axes.plot(1e3 * depth_m, limited_n(model, press), color=colour, lw=1.2, label=label)
    axes.set(xlabel="position, mm", ylabel="force of the model, N")
    axes.legend(frameon=False, fontsize=7, loc="upper left")


def _draw_validation(validation: Validation, axes: "Axes") -> None:
    from springpot.host.wings.report.figures import draw_prediction, typical_series

    draw_prediction(axes, typical_series(series_of(validation)))
    axes.set_xlabel("time, s")


def _draw_check(found: Stability | Emission, axes: "Axes") -> None:
    from springpot.host.wings.report.stability_page import draw_map, scale_of

    if found.check is None:
        raise UsageError(f"no map of stability: {'; '.join(found.notices)}")
    shown = found.check.scene_map
    draw_map(axes, shown, found.check.plan.scene.name, scale_of(shown))


_FACES: dict[
    type, tuple[Callable[[Any], Iterable[str | TextTable]], Callable[[Any, "Axes"], None]]
] = {
    Recording: (_recording_parts, _draw_recording),
    QualityReport: (check_parts, _draw_recordings),
    Fit: (_fit_parts, _draw_fit),
    Validation: (lambda found: _of(validation_rows(found)), _draw_validation),
    Stability: (lambda found: _of(stability_rows(found)), _draw_check),
    Emission: (lambda found: _of(emission_rows(found)), _draw_check),
}
