"""Frama-C's Eva over one emitted folder: every input, any number of ticks.

Eva computes intervals of all variables that hold at every pass of the driver's loop. What it cannot
bound becomes an alarm; a state that may be infinite or no number is counted as one.
"""

import json
import os
import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

DRIVER = Path(__file__).with_name("driver.c")
# Where the analysis keeps the ways through a function apart, and how many of them.
_APART = {
    "sp_guard_position": 60, "sp_guard_plausible": 10, "sp_guard_velocity": 10,
    "sp_guard_share": 20, "sp_is_finite": 10, "sp_idle": 10, "sp_step_dt": 10,
    "sp_forest_traverse": 4000, "sp_forest_sum": 200, "sp_bins_search": 20,
}  # fmt: skip
_BY_RESULT = ("sp_guard_plausible", "sp_guard_velocity", "sp_is_finite")
# Where a number stands twice in an expression: its interval is cut into so many parts.
_PARTS = {
    "sp_poles_next": 30, "sp_slow_poles": 30, "sp_depth_poles": 30, "sp_depth_slow_poles": 30,
    "sp_smooth": 30, "sp_tool_velocity": 30, "sp_rbf_force": 4,
}  # fmt: skip
# Bounds that the analysis tries, one after the other, for a number that grows in the loop.
_BOUNDS = tuple(8.0**power for power in range(-3, 14))


@dataclass(frozen=True)
class Analysis:
    """What Eva said: alarms in its own words, each once; seconds: of wall time."""

    alarms: tuple[str, ...]
    seconds: float


def frama_c() -> str | None:
    """Path of the analyser, None where it is not installed."""
    return shutil.which("frama-c")


def analyse_scene(folder: Path, timeout_s: float = 600.0) -> Analysis:
    """Analyse the emitted C in a folder; writes the driver and Eva's log beside it."""
    manifest = json.loads((folder / "manifest.json").read_text())
    prefix = next(folder.glob("*_scene.c")).name.removesuffix("_scene.c")
    if prefix != "sp":
        raise ValueError(f"{folder}: the driver calls sp_step: emit the scene with the prefix sp")
    text = "".join(path.read_text() for path in sorted(folder.glob("sp_*.[ch]")))
    limits = manifest["limits"]
    floats = [limits["min_n"], limits["max_n"], *_BOUNDS, *(-bound for bound in _BOUNDS)]
    whole = sorted(_sizes(text))
    driver = DRIVER.read_text()
    for mark, value in (
        ("@SCENE@", f"{prefix}_scene"),
        ("@FLOATS@", ", ".join(repr(float(bound)) for bound in floats)),
        ("@WHOLE@", ", ".join(map(str, whole))),
        ("@CALLS@", "2" if "sp_step_dt(" in text else "1"),
    ):
        driver = driver.replace(mark, value)
    (folder / "prove.c").write_text(driver)
    return analyse(folder, "prove.c", text, timeout_s)


def _sizes(text: str) -> set[int]:
    """Last indices of the arrays in the state: where a ring's place ends."""
    return {int(size) - 1 for size in re.findall(r"sp_real \w+\[(?:2 \* )?(\d+)\];", text)}


def analyse(folder: Path, source: str, text: str, timeout_s: float = 600.0) -> Analysis:
    """Run Eva on folder/source from `prove`; text: all of the C, to see which functions exist."""
    share = subprocess.run(
        ["frama-c", "-print-share-path"], capture_output=True, text=True, check=True
    ).stdout.strip()
    command = [
        "frama-c", "-machdep", "gcc_x86_64",
        # The portable traversal of a forest: no vector units.
        f"-cpp-extra-args=-I. -U__x86_64__ -DSP_FOREST_X86_H -I{share}/libc",
        source, "-eva", "-main", "prove", "-warn-special-float", "none",
        "-eva-msg-key=-initial-state", "-eva-auto-loop-unroll", "32",
        "-eva-split-limit", "10000", "-eva-widening-delay", "8", "-eva-widening-period", "1",
    ]  # fmt: skip
    for option, settings in (
        ("-eva-slevel-function", [f"{name}:{ways}" for name, ways in _APART.items()]),
        ("-eva-subdivide-non-linear-function", [f"{name}:{n}" for name, n in _PARTS.items()]),
        ("-eva-split-return-function", [f"{name}:full" for name in _BY_RESULT]),
    ):
        found = [one for one in settings if re.search(rf"\b{one.split(':')[0]}\(", text)]
        command += [option, ",".join(found)] if found else []
    began = time.monotonic()
    log = folder / "eva.log"
    with log.open("w") as out:
        try:
            ended = subprocess.run(
                command,
                cwd=folder,
                env={**os.environ, "PWD": str(folder.resolve())},  # Frama-C believes it
                stdout=out,
                stderr=out,
                timeout=timeout_s,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Analysis((f"no end within {timeout_s:.0f} s",), time.monotonic() - began)
    said = log.read_text()
    seconds = time.monotonic() - began
    if ended.returncode:
        return Analysis((f"Frama-C failed, see {log}",), seconds)
    return Analysis((*_alarms(said), *_unbounded(said)), seconds)


def _alarms(said: str) -> tuple[str, ...]:
    found = re.findall(r"^\[eva:alarm\] (.*?)(?=^\[|\Z)", said, re.MULTILINE | re.DOTALL)
    return tuple(dict.fromkeys(" ".join(one.split()) for one in found))


def _unbounded(said: str) -> tuple[str, ...]:
    """States that are not finite after any number of ticks, as Eva prints them."""
    end = re.search(r"Values at end of function prove:\n(.*?)(?=^\[eva|\Z)", said, re.M | re.S)
    if end is None:
        return ("the driver's loop does not end: nothing is known of its states",)
    ranges = re.findall(r"^ +(\S[^∈]*)∈\s*(.*?)(?=^ +\S[^∈\n]*∈|\Z)", end[1], re.M | re.S)
    return tuple(
        f"state may not be finite: {' '.join(name.split())} in {' '.join(where.split())}"
        for name, where in ranges
        if "inf" in where or "NaN" in where
    )
