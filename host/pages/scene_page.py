"""The report: one self-contained HTML page on an emitted and validated scene."""

import json
from pathlib import Path

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError
from springpot.codegen.types import JsonObject
from springpot.host.emission.emission import read_emission, require_emission
from springpot.host.metrics import JND_WORDS, SCORED_ABOVE_N, floor_words, slope_words
from springpot.host.native.compiler import CompilerError
from springpot.host.native.scene_library import scene_prefix
from springpot.host.native.toolchain import measure_footprint, missing_tools, toolchain
from springpot.host.pages import figures
from springpot.host.pages.page import page_text, plain
from springpot.host.session.outcome import notes_in_words
from springpot.host.validation.store import Stored, read_validation

_REPORT_NAME = "report.html"


def write_report(folder: Path) -> Path:
    """Write folder/report.html from the emission and the last validation; return its path.

    Raises DataError where the folder was not emitted or validated, or changed since.
    """
    stored = _matching_validation(folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    median = figures.median_series(stored.series)
    context = {
        "manifest": manifest,
        "result": stored.metadata["result"],
        "machine": stored.metadata["machine"],
        "recordings": stored.metadata["recordings"],
        "provenance": manifest["provenance"],
        "errors": _error_rows(stored.metadata["result"]),
        "costs": _cost_rows(folder, manifest, stored.metadata["result"]),
        "time_figure": figures.time_figure(median),
        "loop_figure": figures.loop_figure(median),
        "error_figure": figures.error_figure(stored.series),
    }
    path = folder / _REPORT_NAME
    write_file(path, page_text("report.html", context).encode())
    return path


def _matching_validation(folder: Path) -> Stored:
    """Read the last validation. Raises DataError where it is not of this emission."""
    require_emission(folder)
    stored = read_validation(folder)
    result = stored.metadata["result"]
    emitted = read_emission(folder)
    if emitted.hash != result["hash"]:
        raise DataError(f"{folder}: changed since it was validated: `springpot validate` again")
    return stored


def _error_rows(result: JsonObject) -> dict[str, str]:
    """Return the errors of `validate --json` in words."""
    spread = result["mean_recording_rmse_interval_n"]
    interval = f" (95 %: {plain(spread[0])} to {plain(spread[1])} N)" if spread else ""
    below, alone_n = result["ape_below_jnd"], result["model_rmse_n"]
    return {
        "RMSE": f"{plain(result['rmse_n'])} N, "
        f"{plain(result['rmse_percent_of_peak'], 2)} % of the peak",
        "RMSE, mean of recordings": f"{plain(result['mean_recording_rmse_n'])} N{interval}",
        "RMSE of the model alone": "not known" if alone_n is None else f"{plain(alone_n)} N",
        "Mean error": f"{result['mean_error_n']:+.3g} N",
        "Absolute error": f"99 % below {plain(result['p99_abs_error_n'])} N, "
        f"at most {plain(result['max_abs_error_n'])} N",
        "Noise floor": floor_words(result),
        "Error / JND": f"{plain(result['error_per_jnd'])}, rms "
        f"({JND_WORDS})",
        f"Below the JND, above {SCORED_ABOVE_N:g} N": "no such sample"
        if below is None
        else f"{100 * below:.1f} % of samples",
        "Stiffness error, going in": slope_words(result),
        "C against reference": f"{result['mismatches']} of {result['samples']} ticks differ",
        "Ticks with notes": notes_in_words(
            result["notes"], result["clamped_low"], result["min_n"]
        ),
    }  # fmt: skip


def _cost_rows(folder: Path, manifest: JsonObject, result: JsonObject) -> dict[str, str]:
    """Return times of a tick and bytes of memory in words."""
    target, ticks = manifest["target"], result["tick_ns"]
    tools = toolchain(target)
    flash = f"not measured: {missing_tools(target)}"
    if tools is not None:
        try:
            found = measure_footprint(folder, f"{scene_prefix(folder)}.c", tools)
            stack = "" if found.stack_bytes is None else f", stack {found.stack_bytes} bytes"
            flash = f"{found.flash_bytes} bytes ({target}){stack}"
        except CompilerError as error:
            flash = f"not measured: {error}"
    paced = ", ".join(
        f"{name} {plain(ticks[key] / 1e3)} µs"
        for name, key in (("median", "p50"), ("99 %", "p99"), ("99.9 %", "p999"), ("most", "max"))
    )
    return {
        "Tick, hot": f"{plain(ticks['hot_median'] / 1e3)} µs",
        "Tick, paced, caches cold": paced,
        "Flash": flash,
        "RAM": f"{manifest['state_bytes']} bytes of state",
    }
