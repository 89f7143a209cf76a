"""A second closed loop beside that of `springpot stability`: its verdict on holds, scene by scene.

python tests/bench/independent_loop.py [SCENE ...]

Hand, device, delay, encoder and integration are written here anew: a fourth-order Runge-Kutta in
plain numbers, whose only part in common with the tool is sp_step of the emitted shared library,
through ctypes. Each of eleven depths is held for 12 s from a fresh state, by three hands, with and
without one more sample of delay. Prints both verdicts, and how many agree.
"""

import ctypes
import json
import random
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import write_model
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.scene import Coupling, Device, Scene
from springpot.host.emission.emission import emit
from springpot.host.stability.check import stability
from springpot.host.stability.judgement import judge
from springpot.host.wings.evidence.paper.reproduce import Work, simulated
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

HANDS = {"mid": (0.25, 400.0, 6.0), "firm": (0.30, 1000.0, 10.0), "light": (0.12, 300.0, 2.0)}
DEPTHS = [0.05 + 0.105 * i for i in range(11)]
RISE_S, SETTLE_S, HOLD_S = 0.5, 1.5, 12.0
FELT_MPS, GROWTH, DEEPEST = 1e-3, 2.0, 1.5
VERDICTS = ("quiet", "vibrates", "grows")


@dataclass(frozen=True)
class Held:
    """A scene to be held: what is rendered, how, with which device."""

    object_name: str
    kind: str
    device: Device = field(default_factory=Device)
    coupling: Coupling = field(default_factory=Coupling)
    stiffer: float = 1.0


OFF = Coupling(mode="off")
SCENES = {
    "hammerstein, soft": Held("ecoflex-00-30", "hammerstein"),
    "hammerstein": Held("dragon-skin-10", "hammerstein"),
    "rf-fd": Held("dragon-skin-10", "rf-fd"),
    "rf-history": Held("dragon-skin-10", "rf-history"),
    "rf-history, soft": Held("ecoflex-00-30", "rf-history"),
    "2 kg": Held("dragon-skin-10", "hammerstein", Device(mass_kg=2.0)),
    "2 kg, little friction, late": Held(
        "ecoflex-00-30", "hammerstein", Device(mass_kg=2.0, viscous_nspm=0.5, delay_samples=2), OFF
    ),
    "proxy": Held("ecoflex-00-30", "hammerstein", coupling=Coupling("proxy", 6e3, 45.0, 0.05)),
    "tool": Held("ecoflex-00-30", "hammerstein", coupling=Coupling("tool", 3000.0, 20.0, 0.05)),
    "three times stiffer, off": Held("dragon-skin-10", "hammerstein", coupling=OFF, stiffer=3.0),
}


class Rendered:
    """sp_step of a shared library, on a state of its own."""

    def __init__(self, file: str) -> None:
        """Load it; begin with a fresh state."""
        self._c = ctypes.CDLL(file)
        self._c.sp_state_size.restype = ctypes.c_uint32
        self._force_n = ctypes.c_float()
        self._step = self._c.sp_step
        self._step.argtypes = [ctypes.c_void_p, ctypes.c_float, ctypes.c_float, ctypes.c_void_p]
        self.begin()

    def begin(self) -> None:
        """Take a fresh state."""
        self._state = ctypes.create_string_buffer(self._c.sp_state_size() + 64)
        self._at = (ctypes.addressof(self._state) + 63) // 64 * 64
        self._c.sp_init(ctypes.c_void_p(self._at))

    def step(self, position_m: float, velocity_mps: float) -> float:
        """Force of a tick, N."""
        self._step(self._at, position_m, velocity_mps, ctypes.addressof(self._force_n))
        return self._force_n.value


def hold(
    rendered: Rendered, hand: str, device: Device, late: int, depth_m: float, dt_s: float
) -> tuple[np.ndarray, float]:
    """Speed while the hand holds, (n,), m/s, and the deepest position, m."""
    hand_kg, spring_npm, damping_nspm = HANDS[hand]
    mass_kg = hand_kg + (0.3 if device.mass_kg is None else device.mass_kg)
    damping_nspm += 4.0 if device.viscous_nspm is None else device.viscous_nspm
    step_m, noise = 1e-6 * device.resolution_um, random.Random(7)
    rise, ticks = round(RISE_S / dt_s), round((RISE_S + HOLD_S) / dt_s)
    rendered.begin()
    for i in range(rise):  # what the object asks for there
        asked_n = rendered.step(depth_m * (i + 1) / rise, depth_m / RISE_S)
    end_m = depth_m + asked_n / spring_npm
    rendered.begin()
    x = v = seen_before = 0.0
    queue = [0.0] * late
    speeds, deepest = [], 0.0
    for i in range(ticks):
        seen = step_m * round((x + 0.1 * step_m * noise.gauss(0.0, 1.0)) / step_m)
        queue.append(rendered.step(seen, (seen - seen_before) / dt_s))
        seen_before = seen
        share = min((i + 1) / rise, 1.0)
        rest = end_m * share * share * (3.0 - 2.0 * share) - queue.pop(0) / spring_npm
        stiff, soft = spring_npm / mass_kg, damping_nspm / mass_kg
        a1 = stiff * (rest - x) - soft * v
        v2 = v + 0.5 * dt_s * a1
        a2 = stiff * (rest - x - 0.5 * dt_s * v) - soft * v2
        v3 = v + 0.5 * dt_s * a2
        a3 = stiff * (rest - x - 0.5 * dt_s * v2) - soft * v3
        v4 = v + dt_s * a3
        a4 = stiff * (rest - x - dt_s * v3) - soft * v4
        x += dt_s / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        v += dt_s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        speeds.append(v)
        deepest = max(deepest, x)
    return np.array(speeds[rise + round(SETTLE_S / dt_s) :]), deepest


def own_verdict(rendered: Rendered, device: Device, base_late: int, span_m: float) -> str:
    """The gravest over hands, delays and depths, with where it is."""
    worst = (0, 0.0, "")
    high_pass = butter(4, 0.5, "highpass", fs=1000.0, output="sos")
    for hand in HANDS:
        for more in (0, 1):
            for share in DEPTHS:
                speed, deepest = hold(
                    rendered, hand, device, base_late + more, share * span_m, 1e-3
                )
                parts = np.array_split(sosfiltfilt(high_pass, speed), 3)
                first, _, last = (float(np.sqrt(np.mean(part**2))) for part in parts)
                grows = last > FELT_MPS and last > GROWTH * first
                grave = 2 if grows or deepest > DEEPEST * span_m else int(last > FELT_MPS)
                where = f"{1e3 * last:.2f} mm/s, {hand}, {more} more late, {100 * share:.0f} %"
                worst = max(worst, (grave, last, where))
    return f"{VERDICTS[worst[0]]} ({worst[2]})"


def tool_verdict(model: Model, scene: Scene) -> str:
    """That of `springpot stability` on its own holds."""
    found = stability(make_plan(model, scene, accept_unsafe=True))
    holds = [judge(item) for item in found.outcomes if item.case == "hold"]
    grave = max(2 if item.unbounded else int(item.loud) for item in holds)
    return VERDICTS[grave]


@cache
def trained(object_name: str, kind: str) -> Model:
    """A model of a simulated object."""
    training = simulated(object_name, "a", Work(signals=1)).training
    return fit_model(kind, object_name, training, FitOptions(trees=20)).model


def compared(held: Held, folder: Path) -> tuple[str, str]:
    """Own verdict, and the tool's."""
    model = trained(held.object_name, held.kind).stiffened(held.stiffer)
    scene = Scene(schema=1, name="held", model="model.spm", device=held.device,
                  coupling=held.coupling)  # fmt: skip
    write_model(folder / "model.spm", model)
    emit(replace(scene, model="model.spm"), folder / "model.spm", folder / "c", accept_unsafe=True)
    command = [Path(sys.executable).parent / "springpot", "build", folder / "c", "--json"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    library = Rendered(json.loads(printed)["library"])
    own = own_verdict(library, held.device, held.device.delay_samples, model.trained.max_m)
    return own, tool_verdict(model, scene)


def main(names: list[str], say: Callable[[str], None] = print) -> None:
    """Print both verdicts of each scene."""
    agree = 0
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            own, tool = compared(SCENES[name], Path(folder))
        agree += own.startswith(tool)
        say(f"{name}: here {own}; springpot stability {tool}")
    say(f"{agree} of {len(names)} agree")


if __name__ == "__main__":
    main(sys.argv[1:] or list(SCENES))
