"""A tool on an object under the force control of a late sensor, without a clock."""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.native.c_library import CLibrary, load_c
from springpot.host.recording.sensed_press import Delay, late_gains
from springpot.host.simulation.objects import ALL_OBJECTS
from springpot.runtime_c.paths import PORT_POSIX, SIM

_HERE = Path(__file__).parent
_ENCODER_M, _NOISE_N = 1e-5, 0.01
_HEADROOM, _SUBSTEPS_HZ = 1.2, 8000


@dataclass(frozen=True)
class Pressed:
    """One press, each (n,): true positions and forces, and the motor's forces."""

    command_n: Samples
    position_m: Samples
    force_n: Samples
    motor_n: Samples
    fault: int = 0  # of the press, which it ended

    @property
    def seen_m(self) -> Samples:
        """As an encoder has it."""
        return np.round(self.position_m / _ENCODER_M) * _ENCODER_M

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
    wrong: float = 1.0
    spring_npm: float = 0.0
    damper_nspm: float = 0.0
    gap_m: float = 0.0
    name: str = "ecoflex-00-30"
    gains: dict[str, float] = field(default_factory=dict)  # of another control
    max_mps: float = 0.0  # 0: nothing is watched
    goes_wrong: dict[str, float] = field(default_factory=dict)  # wrong_tick, ..., lost_tick, ...

    def press(self, command_n: Samples) -> Pressed:
        """Follow a command, N, one value each ms."""
        gains = self.gains or late_gains(
            Delay(self.sensor_s, self.motor_s, self.wrong * self.mass_kg)
        )
        library = pressed_library()
        command_n = np.ascontiguousarray(command_n)
        max_n = _HEADROOM * float(np.abs(command_n).max())
        settings: dict[str, Any] = {
            "command_n": library.array(command_n), "n": len(command_n), "dt_s": 1e-3,
            "max_force_n": max_n, "watchdog_s": 0.02, "max_mps": self.max_mps, **gains,
        }  # fmt: skip
        press = library.ffi.new("sp_press *", settings)
        tool = library.ffi.new("pressed_tool *", {
            "mass_kg": self.mass_kg, "viscous_nspm": self.viscous_nspm,
            "coulomb_n": self.coulomb_n, "encoder_m": _ENCODER_M, "noise_n": _NOISE_N,
            "sensor_late": round(_SUBSTEPS_HZ * self.sensor_s),
            "motor_late": round(_SUBSTEPS_HZ * self.motor_s), "gap_m": self.gap_m,
            "spring_npm": self.spring_npm, "damper_nspm": self.damper_nspm,
            "object": ALL_OBJECTS.index(self.name), **self.goes_wrong,
        })  # fmt: skip
        made = np.zeros((3, len(command_n)))
        status = library.c.pressed_tool_run(tool, press, len(command_n), *map(library.array, made))
        assert status == 0
        return Pressed(command_n, *made, fault=int(press.fault))


@cache
def pressed_library() -> CLibrary:
    headers = [SIM / "sim.h", PORT_POSIX / "sp_press.h", _HERE / "pressed_tool.h"]
    sources = [_HERE / "pressed_tool.c", PORT_POSIX / "sp_press.c", *sorted(SIM.glob("*.c"))]
    return load_c(headers, sources)
