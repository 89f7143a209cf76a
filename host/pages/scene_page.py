"""The report: one self-contained HTML page on an emitted and validated scene."""

import json
from pathlib import Path

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError
from springpot.codegen.types import JsonObject
from springpot.host.emission.emission import read_emission, require_emission
from springpot.host.native.compiler import CompilerError
from springpot.host.native.scene_library import scene_prefix
from springpot.host.native.toolchain import measure_footprint, missing_tools, toolchain
from springpot.host.pages import figures
from springpot.host.pages.page import page_text
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
        "rows": stored.metadata["rows"],
        "costs": _cost_rows(folder, manifest),
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


def _cost_rows(folder: Path, manifest: JsonObject) -> dict[str, str]:
    """Return bytes of memory in words."""
    target = manifest["target"]
    tools = toolchain(target)
    flash = f"not measured: {missing_tools(target)}"
    if tools is not None:
        try:
            found = measure_footprint(folder, f"{scene_prefix(folder)}.c", tools)
            stack = "" if found.stack_bytes is None else f", stack {found.stack_bytes} bytes"
            flash = f"{found.flash_bytes} bytes ({target}){stack}"
        except CompilerError as error:
            flash = f"not measured: {error}"
    return {"flash": flash, "RAM": f"{manifest['state_bytes']} bytes of state"}
