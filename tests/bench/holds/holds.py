"""Hold emitted scenes with 13 hands: does the tool vibrate, and did the verdict say so?

    python tests/bench/holds/holds.py grid OUT
    python tests/bench/holds/holds.py random OUT [--scenes 300] [--seed 1]

grid: what `auto` selects for six simulated objects and a foam with eight devices. random: scenes
of random objects, kinds, couplings and devices. The closed loop (held_device.c) shares no code
with the product's checks. A hold counts by the RMS speed of the tool above .5 Hz in its last
second, two seconds or more after a nudge.
Writes OUT/grid.json or OUT/random.json, a row a scene, and prints a summary.
"""

import argparse
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import expm

sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parents[1]))
from judges_recordings import recorded

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.errors import SpringpotError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Coupling, Device, Runtime, Scene
from springpot.host.native.c_library import load_c
from springpot.host.native.scene_library import SceneLibrary, build_and_load, without_coupling
from springpot.host.stability.check import check
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording

HERE = Path(__file__).parent
OBJECTS = (
    "foam", "ecoflex-00-30", "bergstrom-boyce", "dragon-skin-10", "poro-viscoelastic", "mullins",
    "stiffening-tissue",
)  # fmt: skip
AIR_M, PRESS_S, RISE_S = -1e-3, 1.0, 0.8
NUDGE_N, NUDGE_S, NUDGED_AT_S = 0.5, 0.02, 1.0
GRID_HOLD_S, RANDOM_HOLD_S = 4.0, 8.0
LOUD_MPS, SHAKES_MPS = 1e-3, 20e-3
LOW_HZ = 0.5
NOISE_SEED = 1  # of the encoder, the same in every hold
FOAM_STROKE, FOAM_NOISE_N = 0.35, 0.005
GRID_DEPTHS = np.append(np.arange(0.05, 1.0, 0.1), 1.1)
RANDOM_DEPTHS = np.array([0.1, 0.35, 0.6, 0.85, 1.1])


@dataclass(frozen=True)
class HeldBy:
    """A hand: its mass moves with the device, on a spring and a damper."""

    mass_kg: float
    stiffness_npm: float
    damping_nspm: float
    late: int = 0


# The three of the checks and the first a sample later; then masses and stiffnesses of a damping
# ratio of .2, which the checks do not know.
HANDS = (
    HeldBy(0.25, 400.0, 6.0), HeldBy(0.03, 5000.0, 5.0), HeldBy(0.03, 50.0, 0.5),
    HeldBy(0.25, 400.0, 6.0, 1),
    *(HeldBy(m, k, 0.4 * math.sqrt(m * k)) for m in (0.03, 0.1, 0.3) for k in (50.0, 500.0, 5e3)),
)  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """A device and its rate."""

    mass_kg: float
    viscous_nspm: float
    delay_samples: int
    rate_hz: int
    resolution_um: float = 10.0

    def scene(self, coupling: Coupling | None = None) -> Scene:
        device = Device(
            mass_kg=self.mass_kg, viscous_nspm=self.viscous_nspm,
            delay_samples=self.delay_samples, resolution_um=self.resolution_um,
        )  # fmt: skip
        return Scene(
            schema=1, name="held", model="model.spm", runtime=Runtime(rate_hz=self.rate_hz),
            device=device, coupling=coupling or Coupling(),
        )  # fmt: skip


SETTINGS = (
    Setting(0.3, 4.0, 0, 1000), Setting(0.1, 1.0, 0, 1000), Setting(0.1, 1.0, 1, 1000),
    Setting(0.05, 0.3, 0, 2000), Setting(0.05, 0.5, 2, 2000), Setting(0.5, 5.0, 0, 500),
    Setting(0.2, 2.0, 2, 1000), Setting(0.075, 0.3, 1, 500),
)  # fmt: skip


def foam_force(position_m: Samples, dt_s: float) -> Samples:
    """Return the force of a foam, (n,), N: most of its stiffness relaxes within 90 ms.

    Its spring densifies, its damping falls with speed (Eyring): no kind of the product has that.
    """
    depth_m = np.maximum(position_m, 0.0)
    held_m = np.zeros(3)
    spring_npm = np.array([3.0e3, 2.0e3, 1.0e3])
    tau_s = np.array([0.004, 0.02, 0.09])
    force_n = np.empty(len(depth_m))
    for i, x in enumerate(depth_m):
        stretched_m = x - held_m
        held_m = x - stretched_m * np.exp(-dt_s / tau_s * (1.0 + np.abs(stretched_m) / 1e-3))
        elastic_n = 1.2e3 * x + 6e9 * x**4
        force_n[i] = max(0.0, elastic_n + float(spring_npm @ (x - held_m)))
    return force_n


@cache
def recordings(name: str) -> tuple[tuple[Recording, ...], tuple[Recording, ...]]:
    """Training and test presses of an object."""
    training, test, _ = recorded("ecoflex-00-30" if name == "foam" else name, "paper")
    if name != "foam":
        return training, test
    return tuple(map(_press_foam, training)), tuple(map(_press_foam, test))


def _press_foam(recording: Recording) -> Recording:
    position_m = FOAM_STROKE * recording.position_m
    noise_n = FOAM_NOISE_N * np.random.default_rng(1).standard_normal(len(position_m))
    force_n = foam_force(position_m, recording.dt_s) + noise_n
    return replace(recording, position_m=position_m, force_n=force_n)


@cache
def model(name: str, kind: str = "hammerstein") -> Model:
    return fit_model(kind, name, recordings(name)[0], FitOptions(seed=1)).model


class HeldScene:
    """A built scene and the hands that hold it."""

    def __init__(self, plan: Plan, library: SceneLibrary) -> None:
        self._plan, self._library = plan, library
        self._c = load_c([HERE / "held_device.h"], [HERE / "held_device.c"], library.real)

    def speed_mps(self, hand: HeldBy, depth_fraction: float, hold_s: float) -> float:
        """Return the RMS speed of the tool in the last second of a hold, m/s."""
        dt_s = self._plan.dt_s
        n_press, n_hold = round(PRESS_S / dt_s), round(hold_s / dt_s)
        depth_m = float(self._plan.range.min_m) + depth_fraction * float(
            self._plan.range.max_m - self._plan.range.min_m
        )
        rise = np.minimum(np.arange(n_press) * dt_s / RISE_S, 1.0)
        pressed_m = AIR_M + (0.5 - 0.5 * np.cos(np.pi * rise)) * (depth_m - AIR_M)
        nudge_n = np.zeros(n_hold)
        nudge_n[round(NUDGED_AT_S / dt_s) : round((NUDGED_AT_S + NUDGE_S) / dt_s)] = NUDGE_N
        velocity_mps = np.empty(n_hold)
        state, array = self._library.new_state(), self._c.array
        self._c.c.held_device_run(
            self._device(hand), self._c.pointer(self._library.address("step")),
            self._c.pointer(state.address), n_press, array(pressed_m), n_hold, array(nudge_n),
            array(velocity_mps),
        )  # fmt: skip
        return rms_above(velocity_mps[-round(1.0 / dt_s) :], dt_s)

    def hold(
        self, hands: Sequence[HeldBy], depths: Samples, hold_s: float
    ) -> tuple[Samples, dict[str, Any]]:
        """Return the speed of each hand and depth, (hands, depths), and where it is greatest."""
        speeds_mps = np.array(
            [[self.speed_mps(hand, depth, hold_s) for depth in depths] for hand in hands]
        )
        hand, depth = np.unravel_index(speeds_mps.argmax(), speeds_mps.shape)
        return speeds_mps, {
            "worst_mps": float(speeds_mps.max()),
            "hand": asdict(hands[hand]),
            "depth_fraction": float(depths[depth]),
        }

    def _device(self, hand: HeldBy) -> Any:
        device = self._plan.loop_device
        mass_kg = hand.mass_kg + device.mass_kg
        damping_nspm = hand.damping_nspm + device.viscous_nspm
        rates = np.zeros((3, 3))
        rates[0, 1] = 1.0
        rates[1] = -hand.stiffness_npm / mass_kg, -damping_nspm / mass_kg, 1.0 / mass_kg
        exact = expm(rates * self._plan.dt_s)
        return self._c.ffi.new(
            "held_device *",
            {
                "position": list(exact[0]),
                "velocity": list(exact[1]),
                "step_m": 1e-6 * device.resolution_um,
                "noise_m": 1e-6 * device.noise_um,
                "delay_ticks": device.delay_samples + hand.late,
                "seed": NOISE_SEED,
            },
        )


def rms_above(speed_mps: Samples, dt_s: float) -> float:
    """Return the RMS above LOW_HZ, by the spectrum under a Hann window."""
    window = np.hanning(len(speed_mps))
    power = np.abs(np.fft.rfft((speed_mps - speed_mps.mean()) * window)) ** 2
    within = np.fft.rfftfreq(len(speed_mps), dt_s) > LOW_HZ
    return float(np.sqrt(2.0 * power[within].sum() / (len(speed_mps) * (window**2).sum())))


def coupling_error_percent(plan: Plan, test: tuple[Recording, ...]) -> float:
    """Return how far the coupling takes the force from the model's, % of the peak, in contact."""
    if plan.couple is None and plan.smooth_alpha is None:
        return 0.0
    libraries = build_and_load(without_coupling(plan)), build_and_load(plan)
    errors_n, peak_n = [], 0.0
    for recording in test:
        at_s = np.arange(0.0, (len(recording.position_m) - 1) * recording.dt_s, plan.dt_s)
        stamps_s = recording.dt_s * np.arange(len(recording.position_m))
        position_m = np.interp(at_s, stamps_s, recording.position_m)
        bare_n, coupled_n = (item.new_state().run(position_m)[0] for item in libraries)
        errors_n.append((coupled_n - bare_n)[position_m > 0.0])
        peak_n = max(peak_n, float(np.abs(bare_n).max()))
    return 100.0 * rms(np.concatenate(errors_n)) / peak_n


def run_grid() -> list[dict[str, Any]]:
    """Hold what `auto` selects, for every object and device."""
    rows = []
    for name in OBJECTS:
        for setting in SETTINGS:
            plan = make_plan(model(name), setting.scene(), accept_unsafe=True)
            library = build_and_load(plan)
            speeds_mps, worst = HeldScene(plan, library).hold(HANDS, GRID_DEPTHS, GRID_HOLD_S)
            row = {
                "object": name, "device": asdict(setting), "coupling": plan.coupling.why,
                "mode": plan.coupling.coupling.mode, "cells": speeds_mps.size,
                "loud": int((speeds_mps > LOUD_MPS).sum()),
                "error_percent": coupling_error_percent(plan, recordings(name)[1]), **worst,
            }  # fmt: skip
            rows.append(row)
            print(
                f"{name:18} {setting} {row['mode']:5} {row['error_percent']:5.1f} % "
                f"{1e3 * row['worst_mps']:7.2f} mm/s, {row['loud']} loud",
                flush=True,
            )
    return rows


def sum_up_grid(rows: list[dict[str, Any]]) -> str:
    foam = [row["error_percent"] for row in rows if row["object"] == "foam"]
    bare = sum(row["loud"] for row in rows if row["mode"] == "off")
    return (
        f"{sum(row['loud'] for row in rows)} of {sum(row['cells'] for row in rows)} holds above "
        f"{1e3 * LOUD_MPS:g} mm/s ({bare} without a coupling), worst "
        f"{1e3 * max(row['worst_mps'] for row in rows):.2f} mm/s; the coupling's error "
        f"{np.mean([row['error_percent'] for row in rows]):.1f} % of the peak, foam "
        f"{np.mean(foam):.1f} %; off in {sum(row['mode'] == 'off' for row in rows)} of {len(rows)}"
    )


def random_plan(rng: np.random.Generator) -> Plan:
    """Draw an object, a kind, a coupling and a device."""
    kind = str(rng.choice(("hammerstein", "hammerstein", "rf-fd", "rbf-fd", "springpot")))
    drawn = model(str(rng.choice(OBJECTS)), kind)
    if kind == "hammerstein":
        drawn = drawn.stiffened(float(np.exp(rng.uniform(-1.5, 1.5))))
    setting = Setting(
        mass_kg=float(np.exp(rng.uniform(np.log(0.03), np.log(0.6)))),
        viscous_nspm=float(np.exp(rng.uniform(np.log(0.2), np.log(6.0)))),
        delay_samples=int(rng.integers(0, 4)),
        rate_hz=int(rng.choice((500, 1000, 2000, 4000))),
        resolution_um=float(np.exp(rng.uniform(0.0, np.log(20.0)))),
    )
    stated = Coupling(
        str(rng.choice(("tool", "proxy"))),
        float(np.exp(rng.uniform(np.log(300.0), np.log(2e4)))),
        float(np.exp(rng.uniform(np.log(1.0), np.log(50.0)))),
    )
    coupling = [Coupling(), Coupling("off"), Coupling("off"), stated][int(rng.integers(4))]
    return make_plan(drawn, setting.scene(coupling), accept_unsafe=True)


def run_random(n_scenes: int, seed: int) -> list[dict[str, Any]]:
    """Compare the verdict on random scenes with what every hand does."""
    rng = np.random.default_rng(seed)
    rows = []
    while len(rows) < n_scenes:
        try:
            plan = random_plan(rng)
        except SpringpotError as error:
            print(f"refused before it is built: {error}")
            continue
        library = build_and_load(plan)
        verdict = check(plan, library)
        # The verdict is on the device as it is stated, not on one a sample later.
        own_delay = [hand for hand in HANDS if not hand.late]
        _, worst = HeldScene(plan, library).hold(own_delay, RANDOM_DEPTHS, RANDOM_HOLD_S)
        row = {
            "object": plan.model.name, "kind": plan.model.kind,
            "mode": plan.coupling.coupling.mode, "device": asdict(plan.loop_device),
            "rate_hz": 1.0 / plan.dt_s, "stable": verdict.stable,
            "times_as_stiff": verdict.margin.least,
            "hold_mps": verdict.loudest.hold_speed_mps, **worst,
        }  # fmt: skip
        rows.append(row)
        if row["stable"] == (row["worst_mps"] > SHAKES_MPS):
            print(json.dumps(row), flush=True)
    return rows


def sum_up_random(rows: list[dict[str, Any]]) -> str:
    shakes = np.array([row["worst_mps"] > SHAKES_MPS for row in rows])
    stable = np.array([row["stable"] for row in rows])
    return (
        f"{len(rows)} scenes: {int(stable.sum())} called stable, of which "
        f"{int((stable & shakes).sum())} vibrate above {1e3 * SHAKES_MPS:g} mm/s; "
        f"{int((~stable).sum())} refused, of which {int((~stable & ~shakes).sum())} do not"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("study", choices=("grid", "random"))
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    grid = asked.study == "grid"
    rows = run_grid() if grid else run_random(asked.scenes, asked.seed)
    asked.out.mkdir(parents=True, exist_ok=True)
    (asked.out / f"{asked.study}.json").write_text(json.dumps(rows, indent=1), encoding="utf-8")
    print(sum_up_grid(rows) if grid else sum_up_random(rows))


if __name__ == "__main__":
    main()
