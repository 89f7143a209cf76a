"""What was found, written into a scene's [device]: the rest stays, byte for byte."""

import tomllib
from pathlib import Path

import pytest

from springpot.codegen.errors import UsageError
from springpot.host.emission.scene_file import read_scene
from springpot.host.wings.lab.identification.keys import device_keys, keys_as_toml, write_keys
from springpot.host.wings.lab.identification.result import DeviceMeasured, Identified

HEAD = '# mine\nschema = 1\nname = "x"   # a name\nmodel = "model.spm"\n'
NONE = Identified(why="not found")
KEYS: dict[str, float | int] = {"mass_kg": 0.21, "delay_s": 0.0015, "force_sign": -1}


def measured(**found: Identified) -> DeviceMeasured:
    names = ("mass_kg", "viscous_nspm", "coulomb_n", "delay_s", "position_step_m",
             "velocity_noise_mps", "force_sign", "max_force_n", "bias_n")  # fmt: skip
    return DeviceMeasured(**{name: found.get(name, NONE) for name in names},
                          position_noise_m=0.0, residual_m=0.0, sensor_m=0.0)  # fmt: skip


def written(folder: Path, text: str) -> str:
    """The scene after the keys were written; it reads, and has them."""
    scene = folder / "scene.toml"
    scene.write_bytes(text.encode())
    write_keys(scene, KEYS)
    device = read_scene(scene).device
    assert (device.mass_kg, device.delay_s, device.force_sign) == (0.21, 0.0015, -1)
    assert list(folder.iterdir()) == [scene]
    return scene.read_bytes().decode()


def test_only_what_was_found_becomes_a_key() -> None:
    found = measured(mass_kg=Identified(0.2000049, 0.19, 0.21), force_sign=Identified(-1, -1, -1),
                     position_step_m=Identified(12.5e-6, 12e-6, 13e-6),
                     delay_s=Identified(0.03, 0.03, 0.03))  # fmt: skip
    keys = device_keys(found)
    assert keys == {"mass_kg": 0.2, "resolution_um": 12.5, "force_sign": -1}
    assert tomllib.loads(keys_as_toml(keys)) == {"device": keys}
    assert device_keys(measured()) == {}


def test_a_scene_without_a_device_gets_one_at_its_end(tmp_path: Path) -> None:
    text = written(tmp_path, HEAD + "[runtime]\nrate_hz = 1000.0")
    assert text.startswith(HEAD + "[runtime]\nrate_hz = 1000.0\n\n[device]\n")


def test_keys_are_replaced_where_they_stand(tmp_path: Path) -> None:
    before = (HEAD + "\n [ device ]  # measured\nsurface_mm = 2.5 # of the pad\n"
              "mass_kg   =  0.3 # guessed\n\n# the rest\n[guard]\nmax_force_n = 5.0\n")  # fmt: skip
    after = written(tmp_path, before)
    assert "mass_kg   =  0.21 # guessed\n" in after
    new = ("delay_s = ", "force_sign = ")
    kept = [line for line in after.splitlines() if not line.startswith((*new, "mass_kg"))]
    assert kept == [line for line in before.splitlines() if not line.startswith("mass_kg")]
    assert written(tmp_path, after) == after


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "device = { surface_mm = 1.0 }\n",
        HEAD + "device.surface_mm = 1.0\n",
        HEAD.replace('"x"', '"""\n[device]\n"""'),
    ],
)
def test_a_device_written_otherwise_is_left_alone(tmp_path: Path, text: str) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(text)
    with pytest.raises(UsageError):
        write_keys(scene, KEYS)
    assert scene.read_text() == text
    assert list(tmp_path.iterdir()) == [scene]
