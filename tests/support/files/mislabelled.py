"""CSV files of one object whose signs, units, columns or rate are not what they say.

Its force is known at every row.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from support.files.recording_files import PressedObject, Samples

Outcome = Literal["right", "refused", "warned"]
RATE_HZ = 200.0
_HEADER = ("time_s", "position_mm", "force_N")


@dataclass(frozen=True)
class Mislabelled:
    """text: of the file; options: of the import, as on the command line.

    outcome: refused, with `says` in the line; warned, with a finding of kind `says`; or right.
    """

    name: str
    text: str
    options: tuple[str, ...]
    outcome: Outcome
    says: str = ""


def motion(kind: str) -> Samples:
    """Position into the object of a tool that presses, (n,), m; 0 is the surface."""
    time_s = np.arange(round(12 * RATE_HZ)) / RATE_HZ
    swing = 0.5 - 0.5 * np.cos(2 * np.pi * np.cumsum(np.where(time_s < 6, 0.5, 1.5)) / RATE_HZ)
    if kind == "presses":
        return 6e-3 * swing - 1e-3
    if kind == "preloaded":
        return 2e-3 + 4e-3 * swing
    return np.interp(time_s, [0, 1, 4, 8, 9, 12], [-1e-3, -1e-3, 5e-3, 5e-3, -1e-3, -1e-3])


def true_force_n(position_m: Samples) -> Samples:
    """Force that the object pushes out with, (n,), N."""
    return PressedObject(5e-3, 7.5, 2.0, 0.25).force(position_m, 1.0 / RATE_HZ)


def mislabelled() -> Iterator[Mislabelled]:
    """Every file, each with what has to become of it."""
    yield from _signs()
    yield from _tension()
    yield from _columns()
    yield from _units()
    yield from _rates()


def _signs() -> Iterator[Mislabelled]:
    for kind in ("presses", "preloaded", "one-press"):
        x, f = motion(kind), true_force_n(motion(kind))
        zero = ("--zero", "min") if kind == "preloaded" else ()
        for position_sign, force_sign in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
            name = f"{kind}{position_sign:+d}{force_sign:+d}"
            text = _csv(1e3 * position_sign * x, force_sign * f)
            outcome: Outcome = "right" if position_sign == force_sign == 1 else "refused"
            yield Mislabelled(name, text, zero, outcome, "--map")
    for zero_name, kinds in (("first", ("presses", "preloaded")), ("min", ("presses",))):
        for kind in kinds:
            x, f = motion(kind), true_force_n(motion(kind))
            text = _csv(-1e3 * x, -f)
            options = ("--zero", zero_name)
            yield Mislabelled(f"{kind}-both-{zero_name}", text, options, "refused", "--map")
    x, f = motion("presses"), true_force_n(motion("presses"))
    yield Mislabelled("height", _csv(120.0 - 1e3 * x, f), ("--zero", "min"), "refused", "position=")
    yield Mislabelled("tared-load", _csv(1e3 * x, f - 20.0), ("--tare", "auto"), "right")


def _tension() -> Iterator[Mislabelled]:
    x = np.maximum(motion("presses"), 0.0)
    f = true_force_n(x)
    yield Mislabelled("pulled", _csv(1e3 * x, f), (), "right")
    yield Mislabelled("pulled-force-negative", _csv(1e3 * x, -f), (), "refused", "force=")
    yield Mislabelled("pulled-both-negative", _csv(-1e3 * x, -f), (), "refused", "--map")


def _columns() -> Iterator[Mislabelled]:
    for kind in ("presses", "preloaded", "one-press"):
        x, f = motion(kind), true_force_n(motion(kind))
        yield Mislabelled(f"exchanged-{kind}", _csv(f, 1e3 * x), (), "refused", "no object gives")
    x, f = motion("presses"), true_force_n(motion("presses"))
    late = np.concatenate((np.full(20, f[0]), f[:-20]))
    yield Mislabelled("late-force", _csv(1e3 * x, late), (), "refused", "--force-delay-s")
    yield Mislabelled("constant", _csv(1e3 * x, np.full(len(f), 3.0)), (), "refused", "all along")


def _units() -> Iterator[Mislabelled]:
    x, f = motion("presses"), true_force_n(motion("presses"))
    yield Mislabelled(
        "mm-as-m", _csv(1e3 * x, f, position_header="position_m"), (), "refused", "travel"
    )
    yield Mislabelled("um-as-mm", _csv(1e6 * x, f), (), "refused", "travel")
    yield Mislabelled("m-as-mm", _csv(x, f), (), "warned", "unit")
    yield Mislabelled("mN-as-N", _csv(1e3 * x, 1e3 * f), (), "warned", "unit")
    yield Mislabelled("uN-as-N", _csv(1e3 * x, 1e6 * f), (), "refused", "peak force")
    yield Mislabelled(
        "N-as-kN", _csv(1e3 * x, 1e3 * f, force_header="force_kN"), (), "refused", "peak"
    )
    strain, stress_mpa = x / 33e-3, f / 18.0
    text = _csv(strain, stress_mpa, position_header="Strain", force_header="Stress (MPa)")
    yield Mislabelled("strain", text, (), "refused", "height and area")
    named = ("--map", "position=Strain:mm,force=Stress (MPa):MPa")
    yield Mislabelled("stress-as-force", text, named, "refused", "height and area")
    named = ("--map", "position=Strain:33mm,force=Stress (MPa):18N")
    yield Mislabelled("strain-by-length", text, named, "right")
    named = ("--map", "position=Strain:-33mm,force=Stress (MPa):-18N")
    turned = _csv(-strain, -stress_mpa, position_header="Strain", force_header="Stress (MPa)")
    yield Mislabelled("strain-turned", turned, named, "right")


def _rates() -> Iterator[Mislabelled]:
    x, f = motion("presses"), true_force_n(motion("presses"))
    x_mm, count = 1e3 * x, np.arange(len(x))
    yield Mislabelled("s-as-ms", _csv(x_mm, f, time_header="time_ms"), (), "warned", "unit")
    yield Mislabelled("ms-as-s", _csv(x_mm, f, 1e3 * count / RATE_HZ), (), "warned", "unit")
    yield Mislabelled("count-as-s", _csv(x_mm, f, 1.0 * count), (), "warned", "unit")
    yield Mislabelled("us-as-s", _csv(x_mm, f, 1e6 * count / RATE_HZ), (), "refused", "samples a")
    other = ("--map", "time=1000Hz")
    yield Mislabelled("stated-rate", _csv(x_mm, f), other, "warned", "differs in")
    backwards = _csv(x_mm, f, count[::-1] / RATE_HZ)
    yield Mislabelled("backwards", backwards, (), "refused", "goes back")
    stays = _csv(x_mm, f, np.floor(count / RATE_HZ))
    yield Mislabelled("whole-seconds", stays, (), "refused", "stands still")
    uneven = _csv(x_mm, f, count / RATE_HZ * (1.0 + 0.3 * count / len(count)))
    yield Mislabelled("drifting-clock", uneven, (), "refused", "--resample-hz")


def _csv(position: Samples, force: Samples, time: Samples | None = None, **headers: str) -> str:
    """A file with the numbers as given; time: stamps; headers: other ones, by channel."""
    stamps = np.arange(len(force)) / RATE_HZ if time is None else time
    header = [headers.get(channel.partition("_")[0] + "_header", channel) for channel in _HEADER]
    rows = (f"{t:.9g},{x:.9g},{f:.9g}" for t, x, f in zip(stamps, position, force, strict=True))
    return "\n".join([",".join(header), *rows]) + "\n"
