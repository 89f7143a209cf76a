"""What was found as keys of a scene's [device]: text to paste, or written into the scene."""

import re
import tomllib
from pathlib import Path
from typing import Any

from springpot import UsageError, read_scene
from springpot.basics import written_aside
from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified

_DIGITS = 4
_TABLE = re.compile(r"^[ \t]*\[[ \t]*device[ \t]*\][ \t]*(#.*)?\r?\n", re.M)
_ANY_TABLE = re.compile(r"^[ \t]*\[", re.M)
_OTHER_DELAY = "delay_samples"  # a scene states it or delay_s
_MAX_DELAY_S = 0.02  # of a scene


def device_keys(measured: DeviceMeasured) -> dict[str, float | int]:
    """Return keys of [device] that were found; no others."""
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
    """Return the table, ready to paste."""
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
    """Return the scene with the keys: as TOML, the old content and them."""
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
    device = {**content.get("device", {}), **keys}
    if "delay_s" in keys:
        device.pop(_OTHER_DELAY, None)
    return {**content, "device": device}


def _with_keys(text: str, keys: dict[str, float | int]) -> str:
    """Change the lines of [device] that hold the keys, and add the others below its head."""
    end = "\r\n" if "\r\n" in text else "\n"
    if text and not text.endswith("\n"):
        text += end
    head = _TABLE.search(text)
    if head is None:
        lines = keys_as_toml(keys).split("\n")
        return text + (end if text else "") + "".join(line + end for line in lines)
    after = _ANY_TABLE.search(text, head.end())
    stop = after.start() if after else len(text)
    table, new = text[head.end() : stop], ""
    for name, value in keys.items():
        line = re.compile(rf"^([ \t]*{name}[ \t]*=[ \t]*)[^#\s]+", re.M)
        table, count = line.subn(rf"\g<1>{value}", table)
        new += "" if count else f"{name} = {value}{end}"
    if "delay_s" in keys:
        table = re.sub(rf"^[ \t]*{_OTHER_DELAY}[ \t]*=.*\n", "", table, flags=re.M)
    return text[: head.end()] + new + table + text[stop:]
