"""What was found as keys of a scene's [device]: text to paste, or written into the scene."""

import dataclasses
import re
import tomllib
from pathlib import Path
from typing import Any

from springpot import Device, UsageError, read_scene
from springpot.basics import written_aside
from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified

_DIGITS = 4
_TABLE = re.compile(r"[ \t]*\[[ \t]*device[ \t]*\][ \t]*(#.*)?$")
_ANY_TABLE = re.compile(r"[ \t]*\[")
_SAME = {"delay_s": "delay_samples"}  # a scene states one of the two
_MAX_DELAY_S = 0.02  # of a scene


def device_keys(measured: DeviceMeasured) -> dict[str, float | int]:
    """Keys of [device] that were found; no others."""
    found: dict[str, tuple[Identified, float]] = {
        "mass_kg": (measured.mass_kg, 1.0),
        "viscous_nspm": (measured.viscous_nspm, 1.0),
        "coulomb_n": (measured.coulomb_n, 1.0),
        "delay_s": (measured.delay_s, 1.0),
        "resolution_um": (measured.position_step_m, 1e6),
        "velocity_noise_mps": (measured.velocity_noise_mps, 1.0),
        "max_force_n": (measured.max_force_n, 1.0),
    }
    keys: dict[str, float | int] = {
        name: float(f"{item.value * scale:.{_DIGITS}g}")
        for name, (item, scale) in found.items()
        if item.value is not None
    }
    if keys.get("delay_s", 0.0) > _MAX_DELAY_S:
        del keys["delay_s"]
    if measured.force_sign.value is not None:
        keys["force_sign"] = int(measured.force_sign.value)
    return keys


def keys_as_toml(keys: dict[str, float | int]) -> str:
    """The table, ready to paste."""
    return "\n".join(["[device]", *(f"{name} = {value}" for name, value in keys.items())])


def write_keys(scene: Path, keys: dict[str, float | int]) -> None:
    """Put the keys into a scene's [device]; every other line stays as it is, byte for byte.

    A line `delay_samples` makes room for delay_s. Raises UsageError, and leaves the file alone,
    where its [device] is no table of its own, or where it would not read as a scene.
    """
    after = _checked_text(scene, keys)
    with written_aside(scene) as aside:
        aside.write_bytes(after.encode())
        aside.chmod(scene.stat().st_mode & 0o777)
        read_scene(aside)


def require_writable_device(scene: Path) -> None:
    """Raise UsageError where `write_keys` would not take the scene."""
    _checked_text(scene, {"mass_kg": 1.0})


def _checked_text(scene: Path, keys: dict[str, float | int]) -> str:
    """The scene with the keys: as TOML, the old content and them."""
    read_scene(scene)
    before = scene.read_bytes().decode()
    after = _with_keys(before, keys)
    try:
        right = tomllib.loads(after) == _expected(before, keys)
    except tomllib.TOMLDecodeError:
        right = False
    if not right:
        raise UsageError(
            f"{scene}: its [device] is not one table with a key a line: write it so, or leave "
            "--scene out and paste the keys"
        )
    return after


def _expected(before: str, keys: dict[str, float | int]) -> dict[str, Any]:
    content = tomllib.loads(before)
    device = {name: value for name, value in content.get("device", {}).items()
              if name not in _replaced(keys)}  # fmt: skip
    return {**content, "device": {**device, **keys}}


def _replaced(keys: dict[str, float | int]) -> set[str]:
    """Keys whose line goes, without one of their own."""
    return {other for name, other in _SAME.items() if name in keys}


def _with_keys(text: str, keys: dict[str, float | int]) -> str:
    assert set(keys) <= {field.name for field in dataclasses.fields(Device)}
    lines = text.splitlines(keepends=True)
    end = "\r\n" if lines and lines[0].endswith("\r\n") else "\n"
    begin = next((k for k, line in enumerate(lines) if _TABLE.match(line.rstrip())), None)
    if begin is None:
        if lines and not lines[-1].endswith("\n"):
            lines[-1] += end
        blank = [end] if lines else []
        return "".join([*lines, *blank, *(line + end for line in keys_as_toml(keys).split("\n"))])
    if not lines[begin].endswith("\n"):
        lines[begin] += end
    after = range(begin + 1, len(lines))
    stop = next((k for k in after if _ANY_TABLE.match(lines[k])), len(lines))
    kept, left = [], dict(keys)
    for line in lines[begin + 1 : stop]:
        name = line.split("=")[0].strip()
        if name in left:
            kept.append(_with_value(line, left.pop(name)))
        elif name not in _replaced(keys):
            kept.append(line)
    new = [f"{name} = {value}{end}" for name, value in left.items()]
    return "".join([*lines[: begin + 1], *new, *kept, *lines[stop:]])


def _with_value(line: str, value: float) -> str:
    """The line with another number; its blanks and its comment stay."""
    found = re.match(r"([^=]*=[ \t]*)[^#\s]+(.*)$", line, re.S)
    return f"{found[1]}{value}{found[2]}" if found else line
