"""The scene: how one model is rendered, as the user states it. Key names are the scene file's.

The types carry each key's bounds; the host checks a file against them and names the key.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Gt, Interval

Number = Literal["float32", "float64"]
Target = Literal["host", "cortex-m4f", "cortex-m7", "rv32imafc", "wasm32"]
_CLOSED = {"extra": "forbid", "allow_inf_nan": False, "strict": True}


@dataclass(frozen=True)
class Runtime:
    """Rate (default: the model's own), number type, target, prefix of the C names.

    measured_step: whether there is sp_step_dt, where the model is exact at any rate; by default on
    a host, where loops are late and flash is plenty.
    """

    __pydantic_config__ = _CLOSED
    rate_hz: Annotated[float, Interval(ge=10, le=8000)] | None = None
    number: Number = "float32"
    target: Target = "host"
    prefix: str = "sp"
    forest: Literal["table", "m2cgen"] = "table"
    measured_step: bool | None = None


@dataclass(frozen=True)
class Coupling:
    """Virtual coupling (the paper's figure 12c)."""

    __pydantic_config__ = _CLOSED
    mode: Literal["auto", "off", "tool", "proxy"] = "auto"
    stiffness_npm: Annotated[float, Interval(ge=1e-3, le=1e7)] = 1500.0
    damping_nspm: Annotated[float, Interval(ge=1e-6, le=1e7)] = 20.0
    mass_kg: Annotated[float, Interval(ge=1e-6, le=1e3)] = 0.05


@dataclass(frozen=True)
class Smoothing:
    """Exponential moving average of the force; 0 leaves it out."""

    __pydantic_config__ = _CLOSED
    time_constant_s: Annotated[float, Interval(ge=0, le=1)] = 0.0


@dataclass(frozen=True)
class Guard:
    """Limits; None means the default that the plan derives from the model."""

    __pydantic_config__ = _CLOSED
    max_force_n: Annotated[float, Interval(gt=0, le=1e4)] | None = None
    outside: Literal["fallback", "hold", "zero"] = "fallback"
    watchdog_ms: Annotated[float, Interval(gt=0, le=1000)] | None = None
    contact: Literal["surface", "always"] | None = None
    onset_mm: Annotated[float, Interval(ge=1e-4, le=100)] | None = None


@dataclass(frozen=True)
class Device:
    """What loop checks assume and drivers need; None: not measured, or not stated.

    delay_samples or delay_s: how late its force acts. mass_kg, viscous_nspm, coulomb_n: what a
    hand moves and what brakes it, without the hand. resolution_um: the smallest step of its
    position; velocity_noise_mps: standard deviation of its velocity.
    m_per_turn, sign, zero_turns, max_torque_nm: the transmission of a motor drive;
    nm_per_a: its motor's torque constant.
    force_sign: -1 where a positive command pulls the wrong way. effector_mass_kg: what its own
    gravity compensation carries. weight_n: what the handle weighs beyond that.
    """

    __pydantic_config__ = _CLOSED
    delay_samples: Annotated[int, Interval(ge=0, le=10)] = 0
    delay_s: Annotated[float, Interval(ge=0, le=0.02)] | None = None
    mass_kg: Annotated[float, Interval(ge=1e-3, le=100)] | None = None
    viscous_nspm: Annotated[float, Interval(ge=0, le=1e3)] | None = None
    coulomb_n: Annotated[float, Interval(ge=0, le=1e3)] | None = None
    velocity_noise_mps: Annotated[float, Interval(ge=0, le=10)] | None = None
    velocity: Literal["estimate", "device"] = "estimate"
    surface_mm: float = 0.0
    m_per_turn: Annotated[float, Interval(gt=0, le=100)] | None = None
    sign: Literal[1, -1] = 1
    zero_turns: float = 0.0
    max_torque_nm: Annotated[float, Gt(0)] | None = None
    nm_per_a: Annotated[float, Gt(0)] | None = None
    resolution_um: Annotated[float, Interval(gt=0, le=1e4)] = 10.0
    force_sign: Literal[1, -1] = 1
    max_force_n: Annotated[float, Interval(gt=0, le=1e4)] | None = None
    effector_mass_kg: Annotated[float, Interval(ge=0, le=100)] | None = None
    weight_n: Annotated[float, Interval(ge=-20, le=20)] = 0.0


@dataclass(frozen=True)
class Budget:
    """What the target has to spare; None is no limit."""

    __pydantic_config__ = _CLOSED
    flash_bytes: Annotated[int, Gt(0)] | None = None
    ram_bytes: Annotated[int, Gt(0)] | None = None
    stack_bytes: Annotated[int, Gt(0)] | None = None
    tick_instructions: Annotated[int, Gt(0)] | None = None
    tick_us: Annotated[float, Gt(0)] | None = None


@dataclass(frozen=True)
class Scene:
    """A whole scene file."""

    __pydantic_config__ = _CLOSED
    schema: Literal[1]
    name: str
    model: str
    runtime: Runtime = field(default_factory=Runtime)
    coupling: Coupling = field(default_factory=Coupling)
    smoothing: Smoothing = field(default_factory=Smoothing)
    guard: Guard = field(default_factory=Guard)
    device: Device = field(default_factory=Device)
    budget: Budget = field(default_factory=Budget)
