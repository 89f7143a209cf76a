"""Every key of a scene: its default, the last value that it takes, the first that it does not."""

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.messages import refusing

from springpot import Scene
from springpot.codegen.errors import DataError, UsageError
from springpot.host.emission.scene_file import (
    checked_scene,
    model_path,
    read_scene,
    scene_from_json,
    scene_to_json,
    write_scene,
)

PLAIN = Scene(schema=1, name="x", model="x.spm")
SECTIONS = [
    field.name
    for field in dataclasses.fields(PLAIN)
    if dataclasses.is_dataclass(getattr(PLAIN, field.name))
]
# section.key: default, values at the borders, values beyond them
NUMBERS: dict[str, tuple[float | None, list[float], list[float]]] = {
    "runtime.rate_hz": (None, [10, 8000], [9.99, 8000.5]),
    "coupling.stiffness_npm": (1500.0, [1e-3, 1e7], [0.999e-3, 1.001e7]),
    "coupling.damping_nspm": (20.0, [1e-6, 1e7], [0.999e-6, 1.001e7]),
    "coupling.mass_kg": (0.05, [1e-6, 1e3], [0.999e-6, 1.001e3]),
    "smoothing.time_constant_s": (0.0, [0.0, 1.0], [-1e-9, 1.001]),
    "guard.max_force_n": (None, [1e-9, 1e4], [0.0, 1.001e4]),
    "guard.watchdog_ms": (None, [1e-9, 1000], [0.0, 1000.1]),
    "device.delay_samples": (0, [10, 0], [-1, 11]),
    "device.delay_s": (None, [0.0, 0.02], [-1e-9, 0.0201]),
    "device.mass_kg": (None, [1e-3, 100], [0.999e-3, 100.1]),
    "device.viscous_nspm": (None, [0.0, 1e3], [-1e-9, 1.001e3]),
    "device.coulomb_n": (None, [0.0, 1e3], [-1e-9, 1.001e3]),
    "device.position_noise_um": (None, [0.0, 1e4], [-1e-9, 1.001e4]),
    "device.surface_mm": (0.0, [-1e9, 1e9], []),
    "device.m_per_turn": (None, [1e-9, 100], [0.0, 100.1]),
    "device.zero_turns": (0.0, [-1e9, 1e9], []),
    "device.max_torque_nm": (None, [1e-9, 1e9], [0.0]),
    "device.nm_per_a": (None, [1e-9, 1e9], [0.0]),
    "device.resolution_um": (10.0, [1e-3, 1e4], [0.0, 1.001e4]),
    "device.max_force_n": (None, [1e-9, 1e4], [0.0, 1.001e4]),
    "device.effector_mass_kg": (None, [0.0, 100], [-1e-9, 100.1]),
    "device.weight_n": (0.0, [-20, 20], [-20.1, 20.1]),
    "budget.flash_bytes": (None, [1, 10**12], [0]),
    "budget.ram_bytes": (None, [1, 10**12], [0]),
    "budget.stack_bytes": (None, [1, 10**12], [0]),
    "budget.tick_us": (None, [1e-9, 1e12], [0.0]),
}
WORDS: dict[str, tuple[Any, list[Any]]] = {
    "runtime.number": ("float32", ["float32", "float64"]),
    "runtime.target": ("host", ["host", "cortex-m4f", "cortex-m7", "rv32imafc"]),
    "runtime.prefix": ("sp", ["sp", "s", "a" * 31, "z9_"]),
    "runtime.start": ("auto", ["auto", "rested", "continues"]),
    "coupling.mode": ("auto", ["auto", "off", "tool", "proxy"]),
    "guard.outside": ("fallback", ["fallback", "hold", "zero"]),
    "guard.contact": (None, ["surface", "always"]),
    "device.sign": (1, [1, -1]),
    "device.force_sign": (1, [1, -1]),
}


def with_key(name: str, value: object) -> str:
    """The JSON of a plain scene with one key set."""
    section, _, key = name.rpartition(".")
    content = json.loads(scene_to_json(PLAIN))
    (content[section] if section else content)[key] = value
    return json.dumps(content)


def refused(name: str, value: object) -> None:
    with pytest.raises(UsageError, match=rf"^scene\.toml: {name}") as error:
        scene_from_json(with_key(name, value), "scene.toml")
    assert "\n" not in str(error.value)


def test_the_tables_name_every_key() -> None:
    keys = {
        f"{section}.{field.name}"
        for section in SECTIONS
        for field in dataclasses.fields(getattr(PLAIN, section))
    }
    assert keys == {*NUMBERS, *WORDS}


@pytest.mark.parametrize("name", [*NUMBERS, *WORDS])
def test_a_key_takes_its_values_and_no_others(name: str) -> None:
    default, fits = NUMBERS[name][:2] if name in NUMBERS else WORDS[name]
    section, key = name.split(".")
    assert getattr(getattr(PLAIN, section), key) == default
    for value in fits:
        scene = scene_from_json(with_key(name, value), "")
        assert getattr(getattr(scene, section), key) == value
    for value in [[], {}, "junk!", *(NUMBERS[name][2] if name in NUMBERS else [3.5])]:
        refused(name, value)
    if name in NUMBERS:
        for other in (str(fits[0]), True, math.inf, -math.inf, math.nan):
            refused(name, other)


@pytest.mark.parametrize("section", ["", *SECTIONS])
def test_a_key_that_there_is_none_of_is_told_with_those_that_there_are(section: str) -> None:
    name = f"{section}.colour" if section else "colour"
    place = getattr(PLAIN, section) if section else PLAIN
    known = ", ".join(field.name for field in dataclasses.fields(place))
    with refusing(UsageError, f"scene.toml: {name}: no such key: known here are {known}"):
        scene_from_json(with_key(name, 1), "scene.toml")


@pytest.mark.parametrize("section", SECTIONS)
def test_a_key_that_stands_outside_its_section_is_told_with_it(section: str) -> None:
    for field in dataclasses.fields(getattr(PLAIN, section)):
        with pytest.raises(UsageError, match=rf"no such key: it is one of .*\[{section}\]"):
            scene_from_json(with_key(field.name, 1), "scene.toml")


@pytest.mark.parametrize("prefix", ["", "9a", "_a", "A", "a" * 32, "a-b", "sp_", "sp_x", "int",
                                    "stdint", "math"])  # fmt: skip
def test_a_prefix_that_cannot_begin_c_names_is_refused(prefix: str) -> None:
    refused("runtime.prefix", prefix)


@pytest.mark.parametrize("name", ["", "a\nb", "a\0b", "a/*b", "a*/b", "a??b", "a\\b", "\x7f"])
def test_a_name_that_would_end_a_comment_is_refused(name: str) -> None:
    refused("name", name)


@pytest.mark.parametrize("delay_s", [0.001, 0.0])
def test_a_delay_is_stated_once(delay_s: float) -> None:
    content = json.loads(scene_to_json(PLAIN))
    content["device"] |= {"delay_samples": 1, "delay_s": delay_s}
    with pytest.raises(UsageError) as error:
        scene_from_json(json.dumps(content), "scene.toml")
    told = "scene.toml: device.delay_s: beside delay_samples: state one of the two"
    assert str(error.value) == told


def test_names_and_paths_are_texts_of_any_language() -> None:
    assert scene_from_json(with_key("name", "Grün * / ? 软"), "").name == "Grün * / ? 软"
    refused("model", "a\0b")
    refused("schema", 2)
    refused("schema", 0)


def whole() -> Scene:
    """A scene without a key at its default, but for the delay in ticks beside that in seconds."""
    content = json.loads(scene_to_json(PLAIN))
    content["name"], content["model"] = "Grün", "folder/a\x7f b.spm"
    for name, (_, fits, *_rest) in {**NUMBERS, **WORDS}.items():
        section, key = name.split(".")
        content[section][key] = fits[-1]
    return scene_from_json(json.dumps(content), "")


def test_a_scene_comes_back_as_it_was_written(tmp_path: Path) -> None:
    for scene in (PLAIN, whole()):
        write_scene(tmp_path / "scene.toml", scene)
        assert read_scene(tmp_path / "scene.toml") == scene
        assert scene_from_json(scene_to_json(scene), "") == checked_scene(scene) == scene


@pytest.mark.parametrize("number", [np.float32(5.0), np.float64(5.0), np.int64(5)])
def test_numbers_of_numpy_are_numbers(number: float) -> None:
    scene = dataclasses.replace(PLAIN, guard=dataclasses.replace(PLAIN.guard, max_force_n=number))
    assert checked_scene(scene).guard.max_force_n == 5.0


def test_a_scene_of_python_is_checked_as_a_file_is(tmp_path: Path) -> None:
    wrong = dataclasses.replace(PLAIN, name="a\\b")
    for call in (checked_scene, lambda scene: write_scene(tmp_path / "x.toml", scene)):
        with pytest.raises(UsageError, match=r"^scene: name: "):
            call(wrong)
        with pytest.raises(UsageError, match=r"^scene: .*: give numbers, strings and booleans"):
            call(dataclasses.replace(PLAIN, name=b"x"))  # type: ignore[arg-type]  # refused, that is the test
    assert not list(tmp_path.iterdir())


HEAD = 'schema = 1\nname = "x"\nmodel = "x.spm"\n'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("schema = 1\nname = 'x'", "model: missing: add this key"),
        (HEAD + "[runtime]\nrate = 1000", "runtime.rate: no such key: known here are rate_hz"),
        (HEAD + "[runtime]\nnumber = 'double'", "runtime.number: .*'float32' or 'float64'"),
        (HEAD + "[coupling]\nmass_kg = nan", "coupling.mass_kg"),
        (HEAD + "[runtime", "not a scene"),
        (HEAD + "x = " + "[" * 5000, "not a scene"),
        # a dotted key takes the TOML reader the square of its length, in time and memory
        ("schema = 1\n" + "a." * 31_000 + "b = 1\n", "larger than 16 KiB"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(UsageError, match=rf"scene\.toml.*{told}") as refusal:
        read_scene(tmp_path / "scene.toml")
    assert "\n" not in str(refusal.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"none\.toml: cannot be read"):
        read_scene(tmp_path / "none.toml")
    with pytest.raises(DataError, match=r"`model` of .*scene.toml names it"):
        model_path(PLAIN, tmp_path / "scene.toml")
    (tmp_path / "x.spm").touch()
    assert model_path(PLAIN, tmp_path / "scene.toml") == tmp_path / "x.spm"
