import fcntl
import json

import numpy as np
import pytest
from click.testing import CliRunner

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.commands.recordings.record import record
from springpot.host.recording import protocols
from springpot.trainer.recordings.recording_file import read_recordings

SHORT = "[[profile]]\namplitude_n = 6\nfrequency_hz = 4\n[[profile]]\namplitude_n=3\nhold_s=2\n"


@pytest.fixture
def short(tmp_path):
    file = tmp_path / "short.toml"
    file.write_text(SHORT)
    return file


def run(*arguments):
    return CliRunner().invoke(record, [str(argument) for argument in arguments])


def test_the_papers_protocol(tmp_path):
    out = tmp_path / "made" / "here"
    url = "sim://ecoflex-00-50"
    result = run("--device", url, "--protocol", "paper", "--out", out, "--json")
    assert result.exit_code == 0, result.output
    answer = json.loads(result.stdout)
    assert answer["out"] == str(out)
    assert answer["duration_s"] == 48.85
    recordings = read_recordings([out])
    assert sorted(out.iterdir()) == sorted(out / f"{r.name}.h5" for r in recordings)
    assert [r.name for r in recordings] == [r["name"] for r in answer["recordings"]]
    for read, said, profile in zip(
        recordings, answer["recordings"], protocols.training(), strict=True
    ):
        assert said["file"] == str(out / f"{read.name}.h5")
        assert said["samples"] == len(read.position_m) == len(profile.command_n)
        assert said["duration_s"] == read.duration_s
        assert said["max_depth_m"] == read.position_m.max()
        assert said["max_force_n"] == read.force_n.max()
        error_n = read.force_n - profile.command_n
        assert said["tracking_rms_n"] == pytest.approx(np.sqrt(np.mean(error_n**2)))
        assert read.source == url
        assert read.dt_s == 0.001
        assert read.zero == "none"
        assert read.details["command"]["amplitude_n"] == profile.metadata["amplitude_n"]
        assert read.details["command"]["frequency_hz"] == profile.metadata["frequency_hz"]
    assert max(r["max_depth_m"] for r in answer["recordings"]) == pytest.approx(0.0104, rel=0.02)


def test_the_seed_draws_commands_and_noise(tmp_path, short):
    def record_into(folder, *more):
        arguments = ["--device", "sim://dragon-skin-10", "--protocol", short, "--out", folder]
        assert run(*arguments, *more).exit_code == 0
        return [r.content_hash for r in read_recordings([folder])]

    one = record_into(tmp_path / "1", "--seed", 1)
    same = record_into(tmp_path / "2", "--seed", 1)
    other = record_into(tmp_path / "3", "--seed", 2)
    assert one == same
    assert set(one).isdisjoint(other)


def test_nothing_is_overwritten(tmp_path, short):
    arguments = ["--device", "sim://dragon-skin-10", "--protocol", short, "--out", tmp_path / "o"]
    assert run(*arguments).exit_code == 0
    second = next(iter(sorted((tmp_path / "o").iterdir(), reverse=True)))
    before = {file: file.read_bytes() for file in (tmp_path / "o").iterdir()}
    min(before).unlink()
    result = run(*arguments)
    assert isinstance(result.exception, UsageError)
    assert str(second) in str(result.exception)
    assert [*(tmp_path / "o").iterdir()] == [second]
    assert second.read_bytes() == before[second]


@pytest.mark.parametrize(
    ("url", "protocol", "error", "says"),
    [
        ("omega://0", "paper", DeviceError, "sim://"),
        ("sim://ecoflex-00-30", "papers", UsageError, "validation"),
    ],
)
def test_wrong_use_is_one_line_and_writes_nothing(tmp_path, url, protocol, error, says):
    result = run("--device", url, "--protocol", protocol, "--out", tmp_path / "o")
    assert isinstance(result.exception, error)
    assert says in str(result.exception)
    assert "\n" not in str(result.exception)
    assert not (tmp_path / "o").exists()


def test_a_device_that_is_not_reached_leaves_nothing(tmp_path, short):
    out = tmp_path / "o"
    url = f"serial://{tmp_path / 'no-such-port'}"
    result = run("--device", url, "--protocol", short, "--out", out)
    assert isinstance(result.exception, DeviceError)
    assert "kept" not in result.output
    assert not [*out.rglob("*.*")]


def test_an_interrupted_recording_in_the_way(tmp_path, short):
    journal = tmp_path / "dragon-skin-fx-short-001-6n-4hz.journal"
    journal.touch()
    arguments = ["--device", "sim://dragon-skin-fx", "--protocol", short, "--out", tmp_path]
    result = run(*arguments)
    assert isinstance(result.exception, UsageError)
    assert f"{journal}: keeps a recording that was interrupted" in str(result.exception)
    with journal.open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert "another springpot is recording it now" in str(run(*arguments).exception)


def test_a_file_in_the_way_of_the_folder(tmp_path, short):
    result = run("--device", "sim://ecoflex-00-30", "--protocol", short, "--out", short)
    assert isinstance(result.exception, UsageError)
    assert "--out" in str(result.exception)
