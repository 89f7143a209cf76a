"""The C's forces and notes for stored models, and hashes of them: the same whatever else changes.

`cd tests && python -m support.c.golden_forces` writes them again, after a change that is meant to
change forces; with --models, fitted anew: of the same kinds, sizes and engines as those stored,
which an earlier version fitted, so that a fit may change without its forces.
"""

import argparse
import hashlib
import json
from itertools import product

import numpy as np

from springpot.codegen.emit.golden import differentiate
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import read_model, write_model
from springpot.codegen.scene import Coupling, Guard, Runtime, Scene, Smoothing
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import build_and_load
from support.paths import TESTS
from support.small import fitted

FOLDER = TESTS / "golden" / "forces"
HASHES, FORCES = FOLDER / "forces.json", FOLDER / "forces.npz"
SETTINGS = tuple(product(("float32", "float64"), ("off", "tool", "proxy")))
# Each coupling once, in either number: for what the stored forces show of the others.
EACH_MODE = (("float32", "off"), ("float64", "tool"), ("float32", "proxy"))
_EXP = "numpy's exponentials"
_ROUNDING = {"float32": 1e-6, "float64": 1e-11}


def models() -> list[str]:
    return sorted(file.stem for file in FOLDER.glob("*.spm"))


def model(name: str) -> Model:
    return read_model(FOLDER / f"{name}.spm")


def motion_m() -> np.ndarray:
    """Strokes in and out, some beyond the trained depth, with what devices do wrong, (n,), m.

    Made by additions and products alone, so that every machine makes the same bits.
    """
    strokes = [_stroke(depth, ticks) for depth in (3, 8, 12, 14) for ticks in (90, 210, 400)]
    position_m = np.concatenate([*strokes, strokes[-1][:300], np.full(300, strokes[-1][299])])
    position_m[200:204] = np.nan
    position_m[900] = np.inf
    position_m[1500:1540] = np.nan  # longer than the watchdog waits
    position_m[2100] += 0.5
    position_m[2600:] += 0.001  # a jump that stays
    return position_m


def scene(name: str, number: str, mode: str) -> Scene:
    """One model's scene of SETTINGS."""
    return Scene(
        schema=1,
        name="golden",
        model=f"{name}.spm",
        runtime=Runtime(number=number),  # type: ignore[arg-type]
        coupling=Coupling(mode=mode),  # type: ignore[arg-type]
        smoothing=Smoothing(time_constant_s=0.00083 if mode == "tool" else 0.0),
        guard=Guard(outside="zero" if mode == "tool" else "fallback"),
    )


def replayed(name: str, number: str, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """Forces, N, and notes of one model in one scene, built here; each (n,)."""
    plan = make_plan(model(name), scene(name, number, mode), accept_unsafe=True)
    position = motion_m().astype(plan.dtype)
    return Replay(build_and_load(plan)).run(position, differentiate(position, plan.dt_s))


def force_hash(force_n: np.ndarray, notes: np.ndarray) -> str:
    """SHA-256 of forces and notes."""
    return hashlib.sha256(force_n.tobytes() + notes.tobytes()).hexdigest()


def stored_forces(key: str) -> tuple[np.ndarray, np.ndarray]:
    """Stored forces, N, and notes of "MODEL NUMBER COUPLING"."""
    with np.load(FORCES) as found:
        return found[key], found[f"{key} notes"]


def difference(key: str, force_n: np.ndarray, notes: np.ndarray) -> str:
    """Where forces or notes first leave the stored ones: key, tick, both forces; or nothing.

    Bits, if this processor rounds exponentials as the one that stored them; else notes, and forces
    to _ROUNDING of the peak (9.6e-13 and 0 were seen with all exponentials one bit larger).
    """
    before_n, before = stored_forces(key)
    if exp_hash() == stored_exp_hash():
        bits = f"u{force_n.itemsize}"
        differs = force_n.view(bits) != before_n.view(bits)
    else:
        differs = np.abs(force_n - before_n) > _ROUNDING[force_n.dtype.name] * before_n.max()
    found = np.flatnonzero(differs | (notes != before))
    if not len(found):
        return ""
    tick = int(found[0])
    return (
        f"{key}, tick {tick} of {len(notes)}: {force_n[tick]!r} N and notes {notes[tick]:#x}, "
        f"stored {before_n[tick]!r} N and {before[tick]:#x}"
    )


def exp_hash() -> str:
    """Decays are exponentials, whose last bit depends on the vector units that numpy finds."""
    x = -np.arange(1, 4096) / 512.0
    return hashlib.sha256(np.exp(x).tobytes() + np.expm1(x).tobytes()).hexdigest()


def stored() -> dict[str, str]:
    """Stored hashes, by "MODEL NUMBER COUPLING"."""
    return json.loads(HASHES.read_text())


def stored_exp_hash() -> str:
    return stored()[_EXP]


def _stroke(depth_mm: int, ticks: int) -> np.ndarray:
    phase = np.arange(2 * ticks) / ticks
    share = np.where(phase < 1.0, phase, 2.0 - phase)
    return 1e-3 * depth_mm * share * share * (3.0 - 2.0 * share) - 2e-4


def write() -> None:
    """Write forces, notes and their hashes."""
    hashes, arrays = {_EXP: exp_hash()}, {}
    for name, (number, mode) in product(models(), SETTINGS):
        key = f"{name} {number} {mode}"
        arrays[key], arrays[f"{key} notes"] = found = replayed(name, number, mode)
        hashes[key] = force_hash(*found)
    HASHES.write_text(json.dumps(hashes, indent=1) + "\n")
    np.savez_compressed(FORCES, **arrays)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--models", action="store_true", help="fit the models anew, too")
    for stored_name in models() if parser.parse_args().models else ():
        write_model(FOLDER / f"{stored_name}.spm", fitted(stored_name, trees=4))
    write()
