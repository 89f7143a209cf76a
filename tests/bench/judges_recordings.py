"""Recordings of the simulated judges: a structure of recording, its sensors, its noise floor."""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.peers.truth import ObjectMotion
from support.presses.structures import STRUCTURES, TEST, TRAINING, Part

from springpot.codegen.arrays import rms
from springpot.host.devices.virtual import parse_url
from springpot.host.recording.protocols import RATE_HZ, load_protocol
from springpot.host.simulation.bench import SUBSTEPS, SimulatedBench
from springpot.trainer.recordings.recording import Recording

Recordings = tuple[Recording, ...]
SEED = 1
PAPER_SIGNALS = 4  # of the ten
# What the sensors, and the time between presses, do in each structure of recording.
SETTINGS = {
    "paper": "rest=2",
    "left-out-depth": "",
    "third-repeat": "rest=2",
    "slow-ramps": "rate=50",
    "one-long": "rate=100&drift=0.1",
    "one-speed": "",
    "preload": "glitch=1",
}
_SETTLE_S = 3.0
assert set(SETTINGS) == {"paper", *STRUCTURES}


def recorded(name: str, structure: str, seed: int = SEED) -> tuple[Recordings, Recordings, float]:
    """Press a simulated object. The floor: what the object itself errs, moved as was measured."""
    simulated = parse_url(f"sim://{name}?{SETTINGS[structure]}", seed)
    bench = SimulatedBench(simulated)
    if structure == "paper":
        signals = load_protocol("validation", seed)[:PAPER_SIGNALS]
        parts = [Part(TRAINING, press) for press in load_protocol("paper", seed)]
        parts += [Part(TEST, signal) for signal in signals]
    else:
        parts = STRUCTURES[structure](seed)
    found: dict[str, list[Recording]] = {TRAINING: [], TEST: []}
    errors_n: list[np.ndarray] = []
    dt_s = 1 / bench.rate_hz
    itself = None
    for part in parts:
        position_m, force_n = (each[part.lead :] for each in bench.press(part.profile.command_n))
        if part.lead and simulated.presses.glitch:  # its own is in the lead
            position_m[0] = 0.0
        session = "" if bench.start_s is None else bench.session
        found[part.of].append(
            Recording(
                part.profile.name, position_m, force_n, dt_s, session=session, start_s=bench.start_s
            )
        )
        if itself is None or simulated.presses.rest_s is None:
            itself = ObjectMotion(simulated, dt_s, SUBSTEPS * RATE_HZ // bench.rate_hz)
        else:
            itself.move(np.zeros(round(simulated.presses.rest_s / dt_s)))
        first = 1 if simulated.presses.glitch else 0
        if part.lead:
            itself.move(np.full(round(_SETTLE_S / dt_s), position_m[first]))
        true_n = itself.move(position_m[first:])
        if part.of == TEST:
            errors_n.append(true_n - force_n[first:])
    return tuple(found[TRAINING]), tuple(found[TEST]), rms(np.concatenate(errors_n))
