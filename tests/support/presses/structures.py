"""Protocols with a training and a test part: what one would not dare to predict from the other.

The structures of real recordings on which models were found to fail. Each is a list of presses of
both parts, in the order of recording: the test of a damaged object comes after its damage.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.host.recording.protocols import (
    PEAK_N,
    RATE_HZ,
    Profile,
    cosine_cycles,
    inverted_cosine,
    load_protocol,
)
from springpot.host.recording.session import open_press_device, record_session
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import read_recordings

TRAINING, TEST = "training", "test"
_SPEEDS_HZ = (0.25, 1.0, 4.0)
_PRELOAD_N, _PRELOAD_S, _SETTLE_S = 2.0, 1.0, 2.0
_LONG_S, _LONG_PERIODS_S = 300.0, (0.4, 5.0)
_REST_S = 20.0  # after a slow ramp, at no force


@dataclass(frozen=True)
class Part:
    """A press of the training or the test part; of so many values at its beginning none is kept."""

    of: str
    profile: Profile
    lead: int = 0


def left_out_depth(_seed: int) -> list[Part]:
    """Trained at 2, 4, 8 and 10 N at three speeds, tested at 6 N between them."""
    return [
        _press(TEST if amplitude_n == 6.0 else TRAINING, amplitude_n, frequency_hz)
        for amplitude_n in (2.0, 4.0, 6.0, 8.0, 10.0)
        for frequency_hz in _SPEEDS_HZ
    ]


def third_repeat(_seed: int) -> list[Part]:
    """Three amplitudes at three speeds, all of it three times; tested on the third."""
    return [
        _press(TEST if repeat == 3 else TRAINING, amplitude_n, frequency_hz)
        for repeat in (1, 2, 3)
        for amplitude_n in (4.0, 7.0, 10.0)
        for frequency_hz in (0.5, 1.0, 2.0)
    ]


def slow_ramps(_seed: int) -> list[Part]:
    """Ramps of 10 to 40 s, holds of up to 2 minutes: what creeps and relaxes for minutes."""
    trained = ((3.0, 10.0, 30.0), (6.0, 40.0, 30.0), (10.0, 10.0, 120.0), (10.0, 40.0, 30.0))
    tested = ((8.0, 20.0, 90.0), (5.0, 30.0, 30.0))
    return [*(_ramp(TRAINING, *its) for its in trained), *(_ramp(TEST, *its) for its in tested)]


def one_long(seed: int) -> list[Part]:
    """One recording of 300 s of random presses; tested on three of the paper's sums."""
    draw = np.random.default_rng(seed)
    parts: list[Samples] = []
    while sum(map(len, parts)) < _LONG_S * RATE_HZ:
        amplitude_n = draw.uniform(1.0, PEAK_N)
        period_s = np.exp(draw.uniform(*np.log(_LONG_PERIODS_S)))
        parts.append(cosine_cycles(amplitude_n, 1 / period_s, 1, round(period_s * RATE_HZ)))
    command_n = np.concatenate(parts)[: round(_LONG_S * RATE_HZ)]
    metadata = {"kind": "random cosines", "amplitude_n": PEAK_N, "protocol_seed": seed}
    return [Part(TRAINING, Profile("random", command_n, metadata)), *_sums(seed, 3, PEAK_N)]


def one_speed(_seed: int) -> list[Part]:
    """Four cycles at 1 Hz and three depths; tested three times as fast."""
    return [
        _press(part, amplitude_n, frequency_hz, cycles=4)
        for part, frequency_hz in ((TRAINING, 1.0), (TEST, 3.0))
        for amplitude_n in (2.0, 6.0, 10.0)
    ]


def preload(seed: int) -> list[Part]:
    """The tool never leaves the object: presses on top of 2 N; tested on two sums of cosines."""
    presses = [
        _press(TRAINING, amplitude_n, frequency_hz, cycles=2)
        for amplitude_n in (2.0, 5.0, 8.0)
        for frequency_hz in (0.5, 1.0, 2.0)
    ]
    return [_preloaded(press) for press in (*presses, *_sums(seed, 2, PEAK_N - _PRELOAD_N))]


STRUCTURES: dict[str, Callable[[int], list[Part]]] = {
    "left-out-depth": lambda seed: _numbered(left_out_depth(seed)),
    "third-repeat": lambda seed: _numbered(third_repeat(seed)),
    "slow-ramps": lambda seed: _numbered(slow_ramps(seed)),
    "one-long": lambda seed: _numbered(one_long(seed)),
    "one-speed": lambda seed: _numbered(one_speed(seed)),
    "preload": lambda seed: _numbered(preload(seed)),
}


def recorded(url: str, structure: str, folder: Path) -> list[Recording]:
    """Recordings of both parts, in order, that need no lead."""
    profiles = [part.profile for part in STRUCTURES[structure](11)]
    record_session(open_press_device(url, 11), url, structure, profiles, folder)
    return read_recordings([folder])


def _numbered(parts: list[Part]) -> list[Part]:
    return [
        replace(part, profile=replace(part.profile, name=f"{number:02d}-{part.profile.name}"))
        for number, part in enumerate(parts, start=1)
    ]


def _press(of: str, amplitude_n: float, frequency_hz: float, cycles: int = 1) -> Part:
    n = round(cycles / frequency_hz * RATE_HZ)
    metadata = {"kind": "cosine", "amplitude_n": amplitude_n, "frequency_hz": frequency_hz,
                "cycles": cycles}  # fmt: skip
    command_n = cosine_cycles(amplitude_n, frequency_hz, cycles, n)
    return Part(of, Profile(f"{amplitude_n:g}n-{frequency_hz:g}hz", command_n, metadata))


def _ramp(of: str, amplitude_n: float, rise_s: float, hold_s: float) -> Part:
    corners_s = np.cumsum([0.0, rise_s, hold_s, rise_s, _REST_S])
    t_s = np.arange(round(corners_s[-1] * RATE_HZ)) / RATE_HZ
    command_n = np.interp(t_s, corners_s, [0.0, amplitude_n, amplitude_n, 0.0, 0.0])
    metadata = {"kind": "ramp", "amplitude_n": amplitude_n, "rise_s": rise_s, "hold_s": hold_s}
    return Part(of, Profile(f"{amplitude_n:g}n-{rise_s:g}s", command_n, metadata))


def _sums(seed: int, count: int, peak_n: float) -> Iterator[Part]:
    """The first signals of the paper's validation protocol, as a test."""
    for profile in load_protocol("validation", seed)[:count]:
        command_n = profile.command_n * (peak_n / PEAK_N)
        yield Part(TEST, replace(profile, name="sum", command_n=command_n))


def _preloaded(part: Part) -> Part:
    """On top of a preload, which is reached and settles before anything is kept."""
    profile = part.profile
    rise_n = inverted_cosine(
        np.arange(round(_PRELOAD_S * RATE_HZ)) / RATE_HZ, _PRELOAD_N, 0.5 / _PRELOAD_S
    )
    lead_n = np.concatenate([rise_n, np.full(round(_SETTLE_S * RATE_HZ), _PRELOAD_N)])
    metadata = {**profile.metadata, "preload_n": _PRELOAD_N}
    command_n = np.concatenate([lead_n, profile.command_n + _PRELOAD_N])
    whole = replace(profile, command_n=command_n, metadata=metadata)
    return Part(part.of, whole, lead=len(lead_n))
