"""`springpot place`: the surface is where the tool touches it, three times."""

import json
from pathlib import Path
from typing import Any

import pytest
from support.peer import Peer, cli, peer

from springpot.host.emission.scene_file import read_scene

SCENE = 'schema = 1\nname = "pad"\nmodel = "pad.spm"\n\n[device]\nsurface_mm = 3.0  # old\n'


def placed(device: Peer, *options: object, keys: str = "\n\n\n") -> Any:
    return cli("place", "--device", device.url.partition("&surface_mm")[0], *options, input=keys)


@pytest.mark.realtime
def test_the_surface_of_a_force_dimension_device(tmp_path: Path) -> None:
    """At a height of 12 mm, pressed downwards: -12 mm along the axis; no force meanwhile."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    with peer("dhd_device", "--presses-hz", 0, "--surface-mm", 12) as device:
        result = placed(device, "--scene", scene, "--json")
        assert not device.named("zero")
    assert result.returncode == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["surface_mm"] == pytest.approx(-12.0, abs=0.1)
    assert found["spread_mm"] < 0.1
    assert read_scene(scene).device.surface_mm == found["surface_mm"]
    assert result.stderr.count("press Enter") == 3


@pytest.mark.realtime
def test_a_tool_that_moves_is_no_touch() -> None:
    with peer("serial_device", "--presses-hz", 1) as device:
        result = placed(device)
    assert result.returncode == 1
    assert "the tool moved by" in result.stderr
    assert "keep it still" in result.stderr


def test_nobody_there(tmp_path: Path) -> None:
    with peer("serial_device") as device:
        result = placed(device, keys="")
    assert result.returncode == 2
    assert "run it in a terminal" in result.stderr


def test_wrong_use(tmp_path: Path) -> None:
    for url, words in (
        ("sim://ecoflex-00-30", "give a device that is touched"),
        ("dhd://?surface_mm=3", "leave surface_mm out"),
    ):
        result = cli("place", "--device", url)
        assert result.returncode == 2
        assert words in result.stderr
