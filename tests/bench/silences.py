"""What lost samples do to a scene: energy given back, and force above the one without a loss.

    python tests/bench/silences.py [--write]

Four simulated objects, pressed from 15 to 95 % of the depth at 2 to 8 Hz, with one silence of 5 to
19 ms at each of 24 phases of the second cycle; bare, and behind a proxy of 6000 N/m, 45 N s/m and
50 g. Prints the worst of each, with where it was. --write: into docs/explanation/output.md.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parent))
from judges_recordings import recorded
from support.pages.figures import write_measured
from support.paths import ROOT

from springpot.codegen.arrays import Samples
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Coupling, Scene
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

PAGE = ROOT / "docs/explanation/output.md"
OBJECTS = ("ecoflex-00-30", "bergstrom-boyce", "poro-viscoelastic", "mullins")
COUPLINGS = {"bare": Coupling("off"), "coupled": Coupling("proxy", 6000.0, 45.0, 0.05)}
FREQUENCIES_HZ = (2.0, 4.0, 6.0, 8.0)
SILENCES_S = (0.005, 0.010, 0.014, 0.019)
PHASES, CYCLES, DT_S = 24, 3, 1e-3
SHALLOW, DEEP = 0.15, 0.95  # of the trained depth
SETTLED_S = 0.005  # after the first good sample


@dataclass(frozen=True)
class Effect:
    """given: energy over that of a press, 1. above_n: force above the one without a loss, N."""

    given: float
    above_n: float


@cache
def model(name: str) -> Model:
    """Fit the passive model to the paper's presses of an object."""
    return fit_model("hammerstein", name, recorded(name, "paper")[0], FitOptions()).model


@cache
def scene_of(name: str, coupling: str) -> SceneLibrary:
    """Build the C of an object's scene."""
    scene = Scene(1, "silences", "", coupling=COUPLINGS[coupling])
    return build_and_load(make_plan(model(name), scene, accept_unsafe=True))


def forces(library: SceneLibrary, position_m: Samples, lost: slice) -> Samples:
    """Return the force of each tick, (n,), N, from a fresh state; the ticks of `lost` are idle."""
    state = library.new_state()
    before, _ = state.run(position_m[: lost.start])
    silent = [state.idle(DT_S)[0] for _ in range(lost.start, lost.stop)]
    after, _ = state.run(position_m[lost.stop :])
    return np.concatenate([before, silent, after]).astype(np.float64)


def effects(name: str, coupling: str, frequency_hz: float, silence_s: float) -> Iterator[Effect]:
    """Yield what a silence does at each phase of the second cycle."""
    library, depth_m = scene_of(name, coupling), model(name).trained.max_m
    low_m, high_m = SHALLOW * depth_m, DEEP * depth_m
    time_s = np.arange(round(CYCLES / frequency_hz / DT_S)) * DT_S
    swing_m = 0.5 * (high_m - low_m) * (1.0 - np.cos(2.0 * np.pi * frequency_hz * time_s))
    position_m = np.concatenate([np.linspace(0.0, low_m, 300), low_m + swing_m])
    step_m = np.diff(position_m)
    clean_n = forces(library, position_m, slice(0, 0))
    half = 300 + round(0.5 / frequency_hz / DT_S)
    press_j = float(np.sum(clean_n[300:half] * step_m[300:half]))
    for phase in range(PHASES):
        begin = 300 + round((1.0 + phase / PHASES) / frequency_hz / DT_S)
        end = begin + round(silence_s / DT_S)
        more_n = forces(library, position_m, slice(begin, end)) - clean_n
        settled = end + round(SETTLED_S / DT_S)
        given_j = -float(np.sum(more_n[:-1] * step_m))
        yield Effect(given_j / press_j, float(more_n[settled:].max(initial=0.0)))


def worst(coupling: str, silence_s: float) -> tuple[Effect, tuple[str, float]]:
    """Return the greatest of both figures, and where the greatest energy was."""
    cells = {(name, hz): list(effects(name, coupling, hz, silence_s))
             for name in OBJECTS for hz in FREQUENCIES_HZ}  # fmt: skip
    where = max(cells, key=lambda cell: max(effect.given for effect in cells[cell]))
    above_n = max(effect.above_n for cell in cells.values() for effect in cell)
    return Effect(max(effect.given for effect in cells[where]), above_n), where


def table() -> str:
    """Return the page's table."""
    silences_ms = [f"{1e3 * silence_s:.0f} ms" for silence_s in SILENCES_S]
    lines = [f"| silence | {' | '.join(silences_ms)} |", "| --- " * (1 + len(SILENCES_S)) + "|"]
    for coupling in COUPLINGS:
        found = [worst(coupling, silence_s) for silence_s in SILENCES_S]
        given = [f"{100 * effect.given:.0f} % ({name}, {hz:g} Hz)" for effect, (name, hz) in found]
        above = [f"{effect.above_n:.2f} N" for effect, _ in found]
        for what, cells in (
            ("more energy given back, of a press", given),
            ("force above the one without a loss, 5 ms after it", above),
        ):
            lines.append(f"| {what}, {coupling} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Measure; print, and write where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--write", action="store_true", help=str(PAGE.relative_to(ROOT)))
    asked = parser.parse_args()
    measured = table()
    print(measured)
    if asked.write:
        write_measured(PAGE, "silences", measured)


if __name__ == "__main__":
    main()
