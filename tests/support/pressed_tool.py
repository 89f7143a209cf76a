"""A tool on an object under the force control of a late sensor, without a clock."""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.host.force_sensor.alignment import Delay, alignment_command
from springpot.host.native.c_library import CLibrary, load
from springpot.host.recording.indentation import OPEN_LOOP
from springpot.host.recording.late_control import late_gains, led_command
from springpot.host.simulation.objects import ALL_OBJECTS
from springpot.runtime_c.paths import PORT_POSIX, SIM

_HERE = Path(__file__).parent
_HEADROOM, _SUBSTEPS_HZ = 1.2, 8000


@dataclass(frozen=True)
class Pressed:
    """One press, each (n,): true positions and forces, and the motor's forces."""

    command_n: Samples
    position_m: Samples
    force_n: Samples
    motor_n: Samples

    @property
    def peak(self) -> float:
        """Greatest force, of the greatest command."""
        return float(self.force_n.max() / self.command_n.max())

    @property
    def rms(self) -> float:
        """Of the error, of the greatest command."""
        error_n = self.force_n - self.command_n
        return float(np.sqrt(np.mean(error_n**2)) / self.command_n.max())


@dataclass(frozen=True)
class PressedTool:
    """What is pressed, by what; `wrong`: factor on the mass that the control is given."""

    mass_kg: float = 0.3
    sensor_s: float = 0.003
    motor_s: float = 0.0005
    viscous_nspm: float = 2.0
    coulomb_n: float = 0.1
    encoder_m: float = 1e-5
    wrong: float = 1.0
    motor_gain: float = 1.0
    spring_npm: float = 0.0
    damper_nspm: float = 0.0
    gap_m: float = 0.0
    name: str = "ecoflex-00-30"
    stiffer: float = 1.0
    led: bool = True  # by the compliance that a first press found
    gains: dict[str, float] = field(default_factory=dict)  # of another control

    def press(self, command_n: Samples) -> Pressed:
        """Follow a command, N, one value each ms."""
        found = Delay(self.sensor_s, 0.0, 0.0, self.motor_s, self.wrong * self.mass_kg)
        if self.gains:
            return self._run(command_n, command_n, self.gains)
        compliance_mpn = self._compliance_mpn() if self.led else 0.0
        driven_n = led_command(command_n, compliance_mpn, found)
        return self._run(command_n, driven_n, dict(late_gains(found)))

    def _compliance_mpn(self) -> float:
        chirp = alignment_command(1000.0)
        pressed = self._run(chirp, chirp, dict(OPEN_LOOP))
        swing_n = pressed.force_n - pressed.force_n.mean()
        return max(0.0, float(pressed.position_m @ swing_n / (swing_n @ swing_n)))

    def _run(self, command_n: Samples, driven_n: Samples, gains: dict[str, float]) -> Pressed:
        library = pressed_library()
        driven_n = np.ascontiguousarray(driven_n)
        most_n = _HEADROOM * float(np.abs(command_n).max())
        settings: dict[str, Any] = {
            "command_n": library.array(driven_n), "n": len(driven_n), "dt_s": 1e-3,
            "max_force_n": most_n, "watchdog_s": 0.02, **gains,
        }  # fmt: skip
        press = library.ffi.new("sp_press *", settings)
        tool = library.ffi.new("pressed_tool *", {
            "mass_kg": self.mass_kg, "viscous_nspm": self.viscous_nspm,
            "coulomb_n": self.coulomb_n, "motor_gain": self.motor_gain,
            "encoder_m": self.encoder_m, "noise_n": 0.01,
            "sensor_late": round(_SUBSTEPS_HZ * self.sensor_s),
            "motor_late": round(_SUBSTEPS_HZ * self.motor_s), "gap_m": self.gap_m,
            "spring_npm": self.spring_npm, "damper_nspm": self.damper_nspm,
            "object": ALL_OBJECTS.index(self.name), "stiffer": self.stiffer,
        })  # fmt: skip
        made = np.zeros((3, len(driven_n)))
        status = library.c.pressed_tool_run(tool, press, len(driven_n), *map(library.array, made))
        assert status == 0
        return Pressed(command_n, *made)


@cache
def pressed_library() -> CLibrary:
    headers = [SIM / "sim.h", PORT_POSIX / "sp_press.h", _HERE / "pressed_tool.h"]
    sources = [_HERE / "pressed_tool.c", PORT_POSIX / "sp_press.c", *sorted(SIM.glob("*.c"))]
    return load(headers, sources)
