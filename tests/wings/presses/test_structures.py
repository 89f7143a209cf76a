"""Protocols with a training and a test part, and what the simulated sensors make of them."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from springpot.codegen.errors import UsageError
from springpot.host.commands.recordings.record import record
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import open_device
from springpot.host.recording.protocols import Profile, load_protocol
from springpot.host.simulation.bench import SimulatedBench
from springpot.host.simulation.objects import PressSettings, parse_url
from springpot.host.wings.presses.structures import STRUCTURES
from springpot.trainer.recordings.recording_file import read_recordings

HALF_S = 0.5 * 10 * (1 - np.cos(2 * np.pi * 2 * np.arange(500) / 1000))


def parts(name: str, seed: int = 0) -> dict[str, list[Profile]]:
    profiles = load_protocol(name, seed)
    return {part: [p for p in profiles if p.part == part] for part in ("training", "test")}


@pytest.mark.parametrize("name", STRUCTURES)
def test_every_structure_has_both_parts_and_fits_the_bench(name: str) -> None:
    profiles = load_protocol(name, 3)
    assert {profile.part for profile in profiles} == {"training", "test"}
    names = [profile.name for profile in profiles]
    assert sorted(set(names)) == names
    for profile, again in zip(profiles, load_protocol(name, 3), strict=True):
        assert np.array_equal(profile.command_n, again.command_n)
        assert profile.command_n[0] == 0.0
        assert profile.command_n.min() >= 0.0
        assert profile.command_n.max() <= 10.0 + 1e-9
        assert json.dumps(dict(profile.metadata))


def test_the_test_is_what_was_not_trained() -> None:
    def found(name: str, part: str, key: str) -> set[float]:
        return {profile.metadata[key] for profile in parts(name)[part]}

    assert found("left-out-depth", "training", "amplitude_n") == {2.0, 4.0, 8.0, 10.0}
    assert found("left-out-depth", "test", "amplitude_n") == {6.0}
    assert found("third-repeat", "training", "repeat") == {1, 2}
    assert found("third-repeat", "test", "repeat") == {3}
    assert found("one-speed", "training", "frequency_hz") == {1.0}
    assert found("one-speed", "test", "frequency_hz") == {3.0}
    assert [len(p.command_n) for p in parts("one-long")["training"]] == [300_000]
    assert max(len(p.command_n) for p in parts("slow-ramps")["training"]) > 120_000


def test_nothing_of_a_preload_s_approach_is_kept() -> None:
    profile = parts("preload")["training"][0]
    assert profile.command_n[profile.lead] == pytest.approx(2.0)
    bench = SimulatedBench(parse_url("sim://ecoflex-00-50"))
    whole_m, whole_n = bench.press(profile.command_n)
    again = SimulatedBench(parse_url("sim://ecoflex-00-50"))
    position_m, force_n = again.press(profile.command_n, lead=profile.lead)
    assert np.array_equal(position_m, whole_m[profile.lead :])
    assert np.array_equal(force_n, whole_n[profile.lead :])
    assert force_n.min() > 1.8


def test_a_rested_object_remembers_and_a_fresh_one_does_not() -> None:
    depths_m = {}
    for query in ("", "?rest=1"):
        bench = SimulatedBench(parse_url(f"sim://mullins{query}"))
        depths_m[query] = [bench.press(0.5 * HALF_S)[0].max() for _ in range(1)]
        bench.press(HALF_S)
        depths_m[query].append(bench.press(0.5 * HALF_S)[0].max())
    fresh, rested = depths_m[""], depths_m["?rest=1"]
    assert fresh[1] == pytest.approx(fresh[0], abs=3e-5)
    assert rested[1] > rested[0] + 5e-4  # damaged by the deep press between


def test_rate_drift_and_glitch_change_what_is_kept_alone() -> None:
    def pressed(query: str) -> tuple[np.ndarray, np.ndarray]:
        taken: list[tuple[np.ndarray, np.ndarray]] = []
        bench = SimulatedBench(parse_url(f"sim://ecoflex-00-50{query}"))
        position_m, force_n = bench.press(HALF_S, lambda x, f: taken.append((x, f)))
        assert np.array_equal(np.concatenate([x for x, _ in taken]), position_m)
        return position_m, force_n

    position_m, force_n = pressed("")
    for rate_hz in (500, 50, 8):
        slow_m, slow_n = pressed(f"?rate={rate_hz}")
        assert np.array_equal(slow_m, position_m[:: 1000 // rate_hz])
        assert np.array_equal(slow_n, force_n[:: 1000 // rate_hz])
    drifted_m, drifted_n = pressed("?drift=0.6")
    assert np.array_equal(drifted_m, position_m)
    assert drifted_n - force_n == pytest.approx(1e-5 * np.arange(500))
    glitch_m, glitch_n = pressed("?glitch=1")
    assert np.array_equal(glitch_m[1:], position_m[1:])
    assert glitch_m[0] == 0.0
    assert np.array_equal(glitch_n, force_n)


def test_record_makes_two_folders(tmp_path: Path) -> None:
    url = "sim://dragon-skin-10?rate=50"
    arguments = ["--device", url, "--protocol", "one-speed", "--out", str(tmp_path)]
    result = CliRunner().invoke(record, arguments)
    assert result.exit_code == 0, result.output
    assert f"3 recordings in {tmp_path / 'training'}, 3 recordings in {tmp_path / 'test'}" in (
        result.output.replace("\n", "")
    )
    training, test = (read_recordings([tmp_path / part]) for part in ("training", "test"))
    assert [recording.rate_hz for recording in (*training, *test)] == [50.0] * 6
    assert {len(recording.force_n) for recording in training} == {200}
    again = CliRunner().invoke(record, arguments)
    assert "exists and is not overwritten" in str(again.exception)


@pytest.mark.parametrize(
    ("query", "named"),
    [
        ("rest=-1", "rest=-1: give seconds between 0 and 3600"),
        ("rate=300", "rate=300: the bench samples at 1000 Hz: give a whole part"),
        ("rate=fast", "such as 500"),
        ("drift=2", "N a minute between -1 and 1"),
        ("glitch=yes", "0, 1"),
    ],
)
def test_wrong_settings_are_refused(query: str, named: str) -> None:
    with pytest.raises(UsageError, match=named):
        parse_url(f"sim://mullins?{query}")


def test_a_session_refuses_what_only_a_recording_uses() -> None:
    found = parse_url("sim://mullins?rest=5&rate=100&drift=0.1&glitch=1").presses
    assert found == PressSettings(5.0, 100, 0.1, True)
    requirements = DeviceRequirements(1000, 0.02, 10.0)
    with pytest.raises(UsageError, match="are of recorded presses: leave them out"):
        open_device("sim://mullins?drift=0.1", requirements)
