from pathlib import Path

import pytest

from springpot.codegen.errors import DataError, UsageError
from springpot.host.emission.scene_file import (
    model_path,
    read_scene,
    scene_from_json,
    scene_to_json,
)

HEAD = 'schema = 1\nname = "x"\nmodel = "x.spm"\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def test_every_key_but_three_has_a_default(tmp_path: Path) -> None:
    scene = read_scene(written(tmp_path, HEAD))
    assert scene.runtime.number == "float32"
    assert scene.coupling.mode == "auto"
    assert scene.guard.outside == "fallback"
    with pytest.raises(DataError, match=r"`model` of .*scene.toml names it"):
        model_path(scene, tmp_path / "scene.toml")
    (tmp_path / "x.spm").touch()
    assert model_path(scene, tmp_path / "scene.toml") == tmp_path / "x.spm"


def test_the_designs_example_is_read(tmp_path: Path) -> None:
    text = """
[runtime]
rate_hz = 1000
number = "float64"
target = "cortex-m4f"
[coupling]
mode = "tool"
stiffness_npm = 1500.0
damping_nspm = 20.0
mass_kg = 0.05
[smoothing]
time_constant_s = 0.00083
[guard]
max_force_n = 12.0
outside = "hold"
watchdog_ms = 20
contact = "surface"
onset_mm = 0.15
[device]
delay_samples = 1
velocity = "device"
surface_mm = 0.5
[budget]
flash_bytes = 262144
ram_bytes = 65536
tick_us = 50.0
"""
    scene = read_scene(written(tmp_path, HEAD + text))
    assert scene.budget.tick_us == 50.0
    assert scene.device.delay_samples == 1
    assert scene_from_json(scene_to_json(scene), "json") == scene


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("schema = 2\nname = 'x'\nmodel = 'x'", "schema"),
        ("schema = 1\nname = 'x'", "model: missing: add this key"),
        (HEAD + "[runtime]\nrate_hz = 9000", "runtime.rate_hz"),
        (HEAD + "[runtime]\nrate = 1000", "runtime.rate: no such key: known here are rate_hz"),
        (HEAD + "[runtime]\nnumber = 'double'", "runtime.number: .*'float32' or 'float64'"),
        (HEAD + "[runtime]\nprefix = '9x'", "runtime.prefix"),
        (HEAD + "[coupling]\nmass_kg = 0", "coupling.mass_kg"),
        (HEAD + "[coupling]\nmass_kg = nan", "coupling.mass_kg"),
        (HEAD + "[guard]\nmax_force_n = inf", "guard.max_force_n"),
        (HEAD + "colour = 'red'", "colour: "),
        (HEAD + "[runtime", "not a scene"),
        ("schema = 1\nname = 'a */ b'\nmodel = 'x'", "name: "),
        ("schema = 1\nname = 'a??/'\nmodel = 'x'", "name: "),
        (HEAD + "[runtime]\nprefix = 'sp_guard'", "runtime.prefix"),
        (HEAD + "[runtime]\nprefix = 'float'", "runtime.prefix"),
        (HEAD + "[runtime]\nprefix = 'limits'", "runtime.prefix"),
        (HEAD + "[guard]\nwatchdog_ms = true", "guard.watchdog_ms"),
        (HEAD + "[guard]\nmax_force_n = '12'", "guard.max_force_n"),
        (HEAD + "[guard]\nonset_mm = 1e-50", "guard.onset_mm"),
        (HEAD + "[smoothing]\ntime_constant_s = 1e6", "smoothing.time_constant_s"),
        (HEAD + "x = " + "[" * 5000, "not a scene"),
    ],
)
def test_a_wrong_key_is_named_in_one_line(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(UsageError, match=told) as refusal:
        read_scene(written(tmp_path, text))
    assert "\n" not in str(refusal.value)
    assert "scene.toml" in str(refusal.value)


def test_a_file_that_is_no_scene_by_its_size(tmp_path: Path) -> None:
    """A dotted key takes the TOML reader the square of its length, in time and memory."""
    file = tmp_path / "scene.toml"
    file.write_text("schema = 1\n" + "a." * 31_000 + "b = 1\n")
    with pytest.raises(UsageError, match="larger than 16 KiB"):
        read_scene(file)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"none\.toml: cannot be read"):
        read_scene(tmp_path / "none.toml")
