"""Force commands for recording an object: the paper's protocols, an extended one, a user's own."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.messages import short_repr
from springpot.codegen.types import JsonMapping, JsonObject
from springpot.host.emission.scene_file import checked_keys, toml_as_json

RATE_HZ = 1000
PEAK_N = 10.0
_AMPLITUDES_N = (2.0, 6.0, 10.0)
_FREQUENCIES_HZ = (1 / 5, 1 / 4, 1 / 3, 1 / 2, 1.0, 2.0, 3.0, 4.0, 5.0)
_VALIDATION_SIGNALS, _VALIDATION_S = 10, 15.0
_MULTISINE_S, _MULTISINE_HZ, _MULTISINE_TONES = 15.0, (0.1, 10.0), 12
_HOLD_N, _HOLD_S, _RISE_S = 8.0, 20.0, 0.5
_MAX_BYTES = 1 << 18  # a thousand profiles, each at its place
_Metre = Annotated[float, Field(ge=-1, le=1)]
_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


@dataclass(frozen=True, eq=False)
class Profile:
    """One press: the force to command.

    name: unique within its protocol; names sort in the order of recording.
    command_n: shape (n,), N, one value each ms, from 0.
    place_m: where the object is pressed, x and y; None: where it lies.
    metadata: how the command was made (amplitude_n, frequency_hz, ...); JSON values.
    """

    name: str
    command_n: Samples
    metadata: JsonMapping = field(default_factory=dict)
    place_m: tuple[float, float] | None = None
    __repr__ = short_repr


def inverted_cosine(t_s: Samples, amplitude_n: float, frequency_hz: float) -> Samples:
    """-(a/2) (cos(2 pi v t) - 1), the paper's equations (1) and (2), at the times `t_s`."""
    return amplitude_n / 2 * (1 - np.cos(2 * np.pi * frequency_hz * t_s))


def training() -> list[Profile]:
    """One inverted cosine cycle for each of 3 amplitudes x 9 frequencies (paper III-B).

    27 profiles, 48 850 samples. A cycle of 1/3 s is no whole number of samples: each profile ends
    on the sample nearest to the end of all cycles up to it.
    """
    profiles: list[Profile] = []
    end_s = 0.0
    for amplitude_n in _AMPLITUDES_N:
        for frequency_hz in _FREQUENCIES_HZ:
            begin_s, end_s = end_s, end_s + 1 / frequency_hz
            n = round(end_s * RATE_HZ) - round(begin_s * RATE_HZ)
            metadata = {"amplitude_n": amplitude_n, "frequency_hz": frequency_hz, "cycles": 1}
            name = f"{len(profiles) + 1:02d}-{amplitude_n:g}n-{frequency_hz:.3g}hz"
            command_n = cosine_cycles(amplitude_n, frequency_hz, 1, n)
            profiles.append(Profile(name, command_n, {"kind": "cosine", **metadata}))
    return profiles


def validation(seed: int) -> list[Profile]:
    """Ten signals of 15 s: sums of five random inverted cosines, scaled to 10 N (paper III-C)."""
    draw = np.random.default_rng(seed)
    t_s = np.arange(round(_VALIDATION_S * RATE_HZ)) / RATE_HZ
    profiles = []
    for number in range(1, _VALIDATION_SIGNALS + 1):
        amplitudes_n = draw.uniform(0.2, 1.0, 5)
        frequencies_hz = draw.uniform(0.2, 5.0, 5)
        total_n = np.zeros_like(t_s)
        for amplitude_n, frequency_hz in zip(amplitudes_n, frequencies_hz, strict=True):
            last_zero_s = np.floor(frequency_hz * _VALIDATION_S) / frequency_hz
            element_n = inverted_cosine(t_s, amplitude_n, frequency_hz)
            total_n += np.where(t_s < last_zero_s, element_n, 0.0)
        scale = PEAK_N / total_n.max()
        metadata = {
            "kind": "cosine sum",
            "amplitude_n": (scale * amplitudes_n).tolist(),
            "frequency_hz": frequencies_hz.tolist(),
            "protocol_seed": seed,
        }
        profiles.append(Profile(f"{number:02d}-sum", scale * total_n, metadata))
    return profiles


def extended(seed: int) -> list[Profile]:
    """Return the training protocol, a 15 s multisine (0.1 to 10 Hz) and a 20 s hold.

    Models with a long memory need recordings as long as it.
    """
    profiles = training()
    following = len(profiles) + 1
    metadata = {"kind": "hold", "amplitude_n": _HOLD_N, "hold_s": _HOLD_S, "rise_s": _RISE_S}
    hold = Profile(f"{following + 1:02d}-hold", _hold(_HOLD_N, _HOLD_S, _RISE_S), metadata)
    return [*profiles, _multisine(f"{following:02d}-multisine", seed), hold]


def from_file(path: Path, seed: int) -> list[Profile]:
    """Read a user's protocol: TOML, one [[profile]] table for each press.

    `amplitude_n` with `frequency_hz` and `cycles` (default 1), or with `hold_s` and `rise_s`
    (default 0.5; both ramps lie within hold_s). `protocol`, in place of profiles: all of another
    one, by its name. `places_m`, x and y of each place: all presses are made at each.
    Raises UsageError with the key that is wrong.
    """
    content = toml_as_json(path, _MAX_BYTES, "protocol file")
    keys = {True: [*_ProfileTable.model_fields], False: [*_ProtocolFile.model_fields]}
    adapter = TypeAdapter(_ProtocolFile)
    checked = checked_keys(
        adapter, content, str(path), lambda place: keys[place[:1] == ("profile",)]
    )
    presses = load_protocol(checked.protocol, seed) if checked.protocol else []
    presses += [_from_table(table) for table in checked.profile]
    places: list[tuple[float, float] | None] = [*checked.places_m] or [None]
    pairs = [(place, press) for place in places for press in presses]
    return [
        replace(press, name=f"{number:03d}-{press.name}", place_m=place)
        for number, (place, press) in enumerate(pairs, start=1)
    ]


def load_protocol(protocol: str, seed: int) -> list[Profile]:
    """Return the profiles of a protocol by name, or of a TOML file.

    Raises UsageError where it is neither.
    """
    match protocol:
        case "paper":
            return training()
        case "validation":
            return validation(seed)
        case "extended":
            return extended(seed)
    if not protocol.endswith(".toml"):
        raise UsageError(
            f"protocol {protocol!r}: give paper, validation, extended, or a file ending in .toml"
        )
    return from_file(Path(protocol), seed)


class _ProfileTable(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    amplitude_n: _Positive
    frequency_hz: Annotated[float, Field(gt=0, le=100)] | None = None
    cycles: Annotated[int, Field(ge=1)] = 1
    hold_s: _Positive | None = None
    rise_s: _Positive = _RISE_S

    @model_validator(mode="after")
    def _one_kind(self) -> "_ProfileTable":
        if (self.frequency_hz is None) == (self.hold_s is None):
            raise ValueError("give either frequency_hz (with cycles) or hold_s (with rise_s)")
        if self.hold_s is not None and 2 * self.rise_s > self.hold_s:
            raise ValueError(f"hold_s {self.hold_s:g} is shorter than two ramps of rise_s")
        return self


class _ProtocolFile(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    profile: Annotated[list[_ProfileTable], Field(max_length=999)] = []
    protocol: Literal["paper", "validation", "extended"] | None = None
    places_m: Annotated[list[tuple[_Metre, _Metre]], Field(max_length=999)] = []

    @model_validator(mode="after")
    def _one_source(self) -> "_ProtocolFile":
        if bool(self.profile) == (self.protocol is not None):
            raise ValueError("give either [[profile]] tables or the name of a protocol")
        return self


def _from_table(table: _ProfileTable) -> Profile:
    """Make the command of one press from its table in a user's protocol."""
    metadata: JsonObject = {"amplitude_n": table.amplitude_n}
    if table.frequency_hz is None:
        assert table.hold_s is not None
        metadata |= {"kind": "hold", "hold_s": table.hold_s, "rise_s": table.rise_s}
        command_n = _hold(table.amplitude_n, table.hold_s, table.rise_s)
        return Profile(f"{table.amplitude_n:g}n-hold", command_n, metadata)
    metadata |= {"kind": "cosine", "frequency_hz": table.frequency_hz, "cycles": table.cycles}
    n = round(table.cycles / table.frequency_hz * RATE_HZ)
    command_n = cosine_cycles(table.amplitude_n, table.frequency_hz, table.cycles, n)
    name = f"{table.amplitude_n:g}n-{table.frequency_hz:.3g}hz"
    return Profile(name, command_n, metadata)


def cosine_cycles(amplitude_n: float, frequency_hz: float, cycles: int, n: int) -> Samples:
    """Inverted cosines in n samples."""
    t_s = np.minimum(np.arange(n) / RATE_HZ, cycles / frequency_hz)
    return inverted_cosine(t_s, amplitude_n, frequency_hz)


def _hold(amplitude_n: float, duration_s: float, rise_s: float) -> Samples:
    t_s = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
    edge_s = np.minimum(np.minimum(t_s, duration_s - t_s), rise_s)
    return inverted_cosine(edge_s, amplitude_n, 1 / (2 * rise_s))


def _multisine(name: str, seed: int) -> Profile:
    """Log-spaced tones of one amplitude and random phase about 5 N, faded in and out over 1 s."""
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, _MULTISINE_TONES)
    frequencies_hz = np.geomspace(*_MULTISINE_HZ, _MULTISINE_TONES)
    t_s = np.arange(round(_MULTISINE_S * RATE_HZ)) / RATE_HZ
    tones = np.cos(2 * np.pi * frequencies_hz[:, None] * t_s + phases[:, None]).sum(axis=0)
    fade = inverted_cosine(np.minimum(np.minimum(t_s, _MULTISINE_S - t_s), 1.0), 1.0, 0.5)
    raised = fade * (tones - tones.min())
    metadata = {
        "kind": "multisine",
        "amplitude_n": PEAK_N,
        "frequency_hz": frequencies_hz.tolist(),
        "protocol_seed": seed,
    }
    return Profile(name, raised * (PEAK_N / raised.max()), metadata)
