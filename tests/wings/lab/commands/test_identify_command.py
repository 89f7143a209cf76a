"""The command `identify`: consent, refusals, and once the whole test against the clock."""

import json
import sys
from pathlib import Path

import pytest
from support.in_process import spring
from support.small import model_file

from springpot.host.emission.scene_file import read_scene

URL = "sim://free?mass=0.2&viscous=2&coulomb=0.1&delay_ms=1.5&step_um=10&sign=-1&noise_um=3&seed=1"
TRUTH = {"mass_kg": 0.2, "viscous_nspm": 2.0, "coulomb_n": 0.1, "delay_s": 0.0015,
         "position_step_m": 1e-5, "force_sign": -1, "max_force_n": 10.0}  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "status", "says"),
    [
        ((URL,), 2, "give --yes"),
        (("sim://free?weight=1", "--yes"), 2, "no setting 'weight'"),
        (("sim://free?sign=0", "--yes"), 2, "give 1 or -1"),
        (("sim://free?max_n=1", "--yes"), 5, "give --max-force-n 1"),
        (("sim://ecoflex-00-30", "--yes"), 2, "is no device that is free to move"),
        (("replay://press.h5", "--yes"), 2, "is no device that is free to move"),
        (("usb://x", "--yes"), 5, "no driver"),
        (("sim://free?bias_n=5", "--yes"), 5, "moves by itself"),
    ],
)
def test_refusals(arguments: tuple[str, ...], status: int, says: str) -> None:
    done = spring("identify", "--device", *arguments)
    assert done.returncode == status, done.stderr
    assert says in done.stderr.splitlines()[-1]
    assert done.stdout == ""


def test_a_person_at_a_terminal_may_say_no(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("click.prompt", lambda *_words, **_options: "n")
    done = spring("identify", "--device", URL)
    assert done.returncode == 2
    assert "at most 2 N and 20 mm to either side" in done.stderr
    assert "nothing moved" in done.stderr


@pytest.mark.parametrize("command", ["run", "record"])
def test_it_is_there_to_be_measured_only(command: str, tmp_path: Path) -> None:
    model_file(tmp_path)
    scene = tmp_path / "scene.toml"
    scene.write_text('schema = 1\nname = "pad"\nmodel = "model.spm"\n')
    more = {"run": ("--scene", scene), "record": ("--protocol", "paper", "--out", tmp_path)}
    done = spring(command, "--device", "sim://free", *more[command])
    assert done.returncode == 2
    assert "free" in done.stderr.splitlines()[-1]


@pytest.mark.realtime
def test_the_whole_test_in_real_time(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    head = '# a pad\nschema = 1\nname = "pad"\nmodel = "model.spm"\n'
    scene.write_text(head)
    done = spring("identify", "--device", URL, "--yes", "--scene", scene, "--json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    for name, value in TRUTH.items():
        assert answer[name]["value"] == pytest.approx(value, rel=0.1), name
        assert answer[name]["low"] <= answer[name]["value"] <= answer[name]["high"]
    assert answer["velocity_noise_mps"]["value"] == pytest.approx(0.0059, rel=0.15)
    assert answer["scene"] == str(scene)
    assert scene.read_text().startswith(head)
    device = read_scene(scene).device
    for name, value in answer["keys"].items():
        assert getattr(device, name) == value
    assert device.resolution_um == pytest.approx(10.0)
