"""Presses at several places, on a simulated lump and on a rig that has one axis."""

import io
from pathlib import Path

import pytest
from support.presses.places import grid_profiles

from springpot.codegen.errors import UsageError
from springpot.host.recording.indentation import Limits, PressedDevice
from springpot.host.recording.session import open_press_device, record_session
from springpot.trainer.recordings.recording_file import read_recordings


def test_a_simulated_lump_is_recorded_at_each_place(tmp_path: Path) -> None:
    device = open_press_device("sim://lump")
    short = [press for press in grid_profiles(3) if press.metadata["frequency_hz"] == 5.0][2::3]
    record_session(device, "sim://lump", "map.toml", short, tmp_path / "rec")
    found = read_recordings([tmp_path / "rec"])
    assert [recording.place_m for recording in found] == [press.place_m for press in short]
    deepest = {press.place_m: press.position_m.max() for press in found}
    assert len(deepest) > 4 and max(deepest.values()) > 1.1 * min(deepest.values())


def test_on_a_rig_it_asks_for_each_new_place_and_waits_for_enter(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    device = PressedDevice("serial:///dev/null", "pad", Limits(), lambda _progress: None)
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    device.go_to((0.005, 0.01))
    device.go_to((0.005, 0.01))
    said = capsys.readouterr()
    assert (said.out + said.err).count("put x = 5 mm, y = 10 mm of the object under the tool") == 1
    with pytest.raises(UsageError, match="nobody presses Enter"):
        device.go_to((0.0, 0.0))
