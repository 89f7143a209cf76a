"""The protocol of places: sites far apart first, presses at each, and what is refused."""

import io
from pathlib import Path

import numpy as np
import pytest

from springpot.codegen.errors import UsageError
from springpot.host.recording.indentation import Limits, PressedDevice
from springpot.host.recording.protocols import load_protocol
from springpot.host.recording.session import open_press_device, record_session
from springpot.trainer.recordings.recording_file import read_recordings

SPREAD = 'span_m = [0.03, 0.02]\nsites = "spread"\nfull = 2\nshort = 4\n'


def protocol(folder: Path, table: str) -> str:
    path = folder / "map.toml"
    path.write_text(f"[places]\n{table}")
    return str(path)


def test_sites_are_spread_and_the_first_are_full(tmp_path: Path) -> None:
    profiles = load_protocol(protocol(tmp_path, SPREAD), 0)
    sites = list(dict.fromkeys(profile.place_m for profile in profiles))
    places = np.array(sites)
    assert len(sites) == 6
    np.testing.assert_array_equal(places.min(axis=0), [0.0, 0.0])
    np.testing.assert_array_equal(places.max(axis=0), [0.03, 0.02])
    counts = [sum(profile.place_m == site for profile in profiles) for site in sites]
    assert counts == [27, 27, 2, 2, 2, 2]
    assert np.linalg.norm(places[1] - places[0]) > 0.015


def test_a_simulated_lump_is_recorded_at_each_site(tmp_path: Path) -> None:
    sites = [(0.01, 0.011), (0.026, 0.004), (0.02, 0.02), (0.0, 0.03)]
    table = f"full = 1\nsites = {[list(site) for site in sites]}\n"
    profiles = load_protocol(protocol(tmp_path, table), 0)
    assert {profile.place_m for profile in profiles} == set(sites)
    device = open_press_device("sim://lump")
    short = profiles[27:]
    record_session(device, "sim://lump", "map.toml", short, tmp_path / "rec")
    found = read_recordings([tmp_path / "rec"])
    assert [recording.place_m for recording in found] == [press.place_m for press in short]
    deepest = {press.place_m: press.position_m.max() for press in found}
    assert max(deepest.values()) > 1.1 * min(deepest.values())


@pytest.mark.parametrize(
    ("table", "why"),
    [
        ("full = 5\n", "span_m is missing"),
        ("span_m = [0.03, 0.03]\nfull = 1\nshort = 1\n", "2 sites: a map needs four"),
        ("sites = [[0, 0], [1, 0], [0, 1], [1, 1]]\nshort = 2\n", "leave span_m and short out"),
        ("span_m = [0.03, 0.03]\nslides = 4\n", "slides: no such key"),
        (f"{SPREAD}[[profile]]\namplitude_n = 1\n", "stands alone"),
    ],
)
def test_wrong_tables_are_refused_by_key(tmp_path: Path, table: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        load_protocol(protocol(tmp_path, table), 0)


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
