"""The scene: how one model is rendered, as the user states it. Key names are the scene file's.

The types carry each key's bounds; the host checks a file against them and names the key. The text
below a key is its line in the reference (docs/_ext): "Default:" where it is derived, "May be:"
where the type does not say it.
"""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from annotated_types import Gt, Interval

from springpot.codegen.messages import short_repr
from springpot.codegen.model.passive import Start

Number = Literal["float32", "float64"]
Target = Literal["host", "cortex-m4f", "cortex-m7", "rv32imafc"]
_CLOSED = {"extra": "forbid", "allow_inf_nan": False, "strict": True}


@dataclass(frozen=True)
class Runtime:
    """Rate, numbers and names of the C, and what it is compiled for.

    >>> Runtime(rate_hz=2000.0, prefix="pad")
    Runtime(rate_hz=2000.0, prefix='pad')
    """

    __pydantic_config__ = _CLOSED
    rate_hz: Annotated[float, Interval(ge=10, le=8000)] | None = None
    """Ticks a second; another rate than the model's only where all its parts are exact at any.
    Default: the model's own, or 1000 if a loop at that would not hold the object."""
    number: Number = "float32"
    """Type of all numbers in the C."""
    target: Target = "host"
    """Processor for which `emit` states flash and stack."""
    prefix: str = "sp"
    """Beginning of every C name, so that two objects live in one image. May be: lower-case
    letters, digits, underscores."""
    start: Start = "auto"
    """The object as new, or as the training presses left it. Default: as the training recordings
    begin."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Coupling:
    """Virtual coupling (the paper's figure 12c).

    >>> Coupling(mode="off")
    Coupling(mode='off')
    """

    __pydantic_config__ = _CLOSED
    mode: Literal["auto", "off", "tool", "proxy"] = "auto"
    """What stands between tool and model."""
    stiffness_npm: Annotated[float, Interval(ge=1e-3, le=1e7)] = 1500.0
    """Of the coupling's spring, in the modes `tool` and `proxy`."""
    damping_nspm: Annotated[float, Interval(ge=1e-6, le=1e7)] = 20.0
    """Of the coupling's damper."""
    mass_kg: Annotated[float, Interval(ge=1e-6, le=1e3)] = 0.05
    """Of the proxy."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Smoothing:
    """Exponential moving average of the force; 0 leaves it out.

    >>> Smoothing(time_constant_s=0.005)
    Smoothing(time_constant_s=0.005)
    """

    __pydantic_config__ = _CLOSED
    time_constant_s: Annotated[float, Interval(ge=0, le=1)] = 0.0
    """Exponential moving average of the force; 0 leaves it out."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Guard:
    """Limits; None means the default that the plan derives from the model.

    >>> Guard(max_force_n=12.0)
    Guard(max_force_n=12.0)
    """

    __pydantic_config__ = _CLOSED
    max_force_n: Annotated[float, Interval(gt=0, le=1e4)] | None = None
    """The force is clamped there. Default: 1.2 times the maximum trained force."""
    outside: Literal["fallback", "hold", "zero"] = "fallback"
    """Beyond the trained depth: the passive model adds its share, the force stays, or it ends."""
    watchdog_ms: Annotated[float, Interval(gt=0, le=1000)] | None = None
    """Without a good sample for so long, the force goes to zero and latches. Default: 20, and at
    least three ticks."""
    contact: Literal["surface", "always"] | None = None
    """`"surface"`: positions at or below 0 are free air; `"always"`: the tool never leaves the
    object. Default: the model's own."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Device:
    """Figures that loop checks assume and drivers need; None: not measured, or not stated.

    >>> Device(delay_s=0.002, mass_kg=0.1)
    Device(delay_s=0.002, mass_kg=0.1)
    """

    __pydantic_config__ = _CLOSED
    delay_samples: Annotated[int, Interval(ge=0, le=10)] = 0
    """How late the device's force acts: for the checks."""
    delay_s: Annotated[float, Interval(ge=0, le=0.02)] | None = None
    """The same in seconds, in place of `delay_samples`; the checks round it up to whole ticks."""
    mass_kg: Annotated[float, Interval(ge=1e-3, le=100)] | None = None
    """That a hand moves with the device, without the hand: for the checks, which assume 0.3
    without it."""
    viscous_nspm: Annotated[float, Interval(ge=0, le=1e3)] | None = None
    """Friction that grows with speed: for the checks, which assume 4 without it."""
    coulomb_n: Annotated[float, Interval(ge=0, le=1e3)] | None = None
    """Friction that does not: for the closed loop of the checks."""
    position_noise_um: Annotated[float, Interval(ge=0, le=1e4)] | None = None
    """Standard deviation of its readings at rest: the checks assume 0.3 `resolution_um`."""
    surface_mm: float = 0.0
    """Position of the undeformed surface, from the device's zero."""
    m_per_turn: Annotated[float, Interval(gt=0, le=100)] | None = None
    """Travel of the tool for one turn of a motor."""
    sign: Literal[1, -1] = 1
    """-1: positive turns pull the tool out."""
    zero_turns: float = 0.0
    """Motor position of the tool's zero."""
    max_torque_nm: Annotated[float, Gt(0)] | None = None
    """Of the motor."""
    nm_per_a: Annotated[float, Gt(0)] | None = None
    """Torque constant of the motor: 8.27 / KV."""
    resolution_um: Annotated[float, Interval(gt=0, le=1e4)] = 10.0
    """Smallest step of the device's position: `emit` says how much the force may change with it."""
    force_sign: Literal[1, -1] = 1
    """-1: a positive command pulls the tool the wrong way."""
    max_force_n: Annotated[float, Interval(gt=0, le=1e4)] | None = None
    """Largest force of the device: `stability` says where the scene may ask for more."""
    effector_mass_kg: Annotated[float, Interval(ge=0, le=100)] | None = None
    """Mass of the handle, for a device that carries its weight by itself."""
    weight_n: Annotated[float, Interval(ge=-20, le=20)] = 0.0
    """That the handle weighs beyond what the device carries; of `dhd://` devices."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Budget:
    """Memory and time that the target can spare; None is no limit.

    >>> Budget(flash_bytes=16_000, ram_bytes=512)
    Budget(flash_bytes=16000, ram_bytes=512)
    """

    __pydantic_config__ = _CLOSED
    flash_bytes: Annotated[int, Gt(0)] | None = None
    """Code, constants and initialised data of the scene."""
    ram_bytes: Annotated[int, Gt(0)] | None = None
    """One state."""
    stack_bytes: Annotated[int, Gt(0)] | None = None
    """Of a tick, along the deepest path of calls."""
    tick_us: Annotated[float, Gt(0)] | None = None
    """Not checked when emitting: `springpot validate` measures it."""
    __repr__ = short_repr


@dataclass(frozen=True)
class Scene:
    """A whole scene file.

    >>> Scene(1, "pad", "pad.spm", guard=Guard(max_force_n=12.0))
    Scene(schema=1, name='pad', model='pad.spm', guard=Guard(max_force_n=12.0))
    """

    __pydantic_config__ = _CLOSED
    schema: Literal[1]
    """Version of this format."""
    name: str
    """Of the object: in headings, comments and logs. May be: printable text."""
    model: str
    """Model file of `springpot train`, from where the scene file is. May be: a path."""
    runtime: Runtime = field(default_factory=Runtime)
    coupling: Coupling = field(default_factory=Coupling)
    smoothing: Smoothing = field(default_factory=Smoothing)
    guard: Guard = field(default_factory=Guard)
    device: Device = field(default_factory=Device)
    budget: Budget = field(default_factory=Budget)
    __repr__ = short_repr
