"""Points of the benchmark in words: labels for the command line, the figure and the page."""

from collections.abc import Mapping
from typing import Any

from springpot.host.evidence.benchmark.point import Point, Refused

_WORDS = {
    "trees": "{} trees",
    "leaf": "{} in a leaf",
    "n_centers": "{} centres",
    "poles": "{} time constants",
    "engine": "{}",
    "window_s": "window {:.3g} s",
    "number": "{}",
}
_FLAGS = {"round_features": "rounded features", "monotone": "monotone"}


def label(point: Point | Refused) -> str:
    """Return kind and options of a point."""
    options = options_text(point.options)
    return f"{point.model}, {options}" if options else point.model


def options_text(options: Mapping[str, Any]) -> str:
    """Return options of a point, or those that a label leaves out."""
    return ", ".join(
        _FLAGS.get(name) or _WORDS.get(name, name + " {}").format(value)
        for name, value in options.items()
    )


def point_line(point: Point) -> str:
    """Describe a point in a line."""
    return (
        f"{label(point)}: RMSE {point.rmse_n:.3g} N ({point.rmse_percent_of_peak:.2g} % of "
        f"peak), {1e-3 * point.tick_ns_hot:.2g} µs a tick, {flash_text(point)}, "
        f"{point.ram_bytes} bytes of RAM"
    )


def flash_text(point: Point) -> str:
    """Return flash of a point, or that it is not known."""
    count = point.flash_bytes
    return "flash unknown" if count is None else f"{kilobytes(count)} of flash"


def kilobytes(count: int | None) -> str:
    """Return a size for people."""
    if count is None:
        return "unknown"
    return f"{count} bytes" if count < 10_000 else f"{count / 1024:.0f} kB"


def hover(point: Point) -> str:
    """Return label of a point in the figure."""
    active = point.active_cells
    lines = [
        label(point),
        f"RMSE {point.rmse_n:.3g} N, {point.rmse_percent_of_peak:.2g} % of peak "
        f"(cross-validated {point.cv_rmse_n:.3g} N)",
        f"{1e-3 * point.tick_ns_hot:.3g} µs a tick, {flash_text(point)}, "
        f"{point.ram_bytes} bytes of RAM, fitted in {point.fit_s:.2g} s",
        f"non-passive in {active} of {point.cells} cells"
        if active
        else f"no active cell of {point.cells}",
    ]
    if point.bounded is not None:
        lines.append("bounded with every hand" if point.bounded else "NOT bounded with a hand")
    return "\n".join(lines)
