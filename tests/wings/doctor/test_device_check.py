"""`springpot doctor --device`: reached, armed, sampled, of the right sign; or why not."""

import json
from pathlib import Path

import pytest
from support.peer import cli, peer

SCENE = 'schema = 1\nname = "pad"\nmodel = "pad.spm"\n[device]\n'


def examined(url: str, *options: object) -> tuple[int, dict[str, dict]]:
    result = cli("doctor", "--json", "--device", url, *options)
    assert "Traceback" not in result.stderr, result.stderr
    found = json.loads(result.stdout)["findings"]
    return result.returncode, {finding["what"]: finding for finding in found}


@pytest.mark.realtime
@pytest.mark.parametrize("kind", ["serial_device", "dhd_device"])
def test_a_device_that_is_fine(kind: str) -> None:
    with peer(kind, "--presses-hz", 0) as device:
        status, found = examined(device.url, "--yes")
    assert status == 0, found
    assert all(finding["found"] for finding in found.values())
    assert "out of the object, as it must" in found["sign of its force"]["seen"]
    assert "at 1000 Hz" in found["samples"]["seen"]


@pytest.mark.realtime
def test_a_force_of_the_wrong_sign(tmp_path: Path) -> None:
    """A wrong [device] force_sign turns it: it is seen, and what mends it."""
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE + "force_sign = -1\n")
    with peer("serial_device", "--presses-hz", 0) as device:
        status, found = examined(device.url, "--yes", "--scene", scene)
    assert status == 1
    sign = found["sign of its force"]
    assert not sign["found"]
    assert "into the object" in sign["seen"]
    assert "force_sign" in sign["do"]


def test_nothing_pushes_without_consent() -> None:
    with peer("dhd_device", "--presses-hz", 0) as device:
        status, found = examined(device.url)
        assert not device.named("zero")
    assert status == 0
    assert found["sign of its force"]["seen"] == "not tried"
    assert "--yes" in found["sign of its force"]["do"]


def test_a_device_that_is_not_reached() -> None:
    """What else may be in the way: test_dhd_start.py."""
    with peer("dhd_device", "--in-use") as device:
        status, found = examined(device.url)
    assert status == 5
    (reached,) = found.values()
    assert "device already in use" in reached["seen"]
    assert "end that one" in reached["do"]
