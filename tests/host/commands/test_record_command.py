import json

import numpy as np
import pytest
from click.testing import CliRunner

from springpot.codegen.errors import UsageError
from springpot.host.commands.record import record
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
    out, url = tmp_path / "made" / "here", "sim://ecoflex-00-50"
    result = run("--device", url, "--protocol", "paper", "--out", out, "--json")
    assert result.exit_code == 0, result.output
    answer = json.loads(result.stdout)
    assert (answer["out"], answer["duration_s"]) == (str(out), 48.85)
    recordings = read_recordings([out])
    assert sorted(out.iterdir()) == sorted(out / f"{r.name}.h5" for r in recordings)
    for read, said, profile in zip(
        recordings, answer["recordings"], protocols.training(), strict=True
    ):
        error_n = read.force_n - profile.command_n
        assert said["tracking_rms_n"] == pytest.approx(np.sqrt(np.mean(error_n**2)))
        assert (said["name"], said["file"]) == (read.name, str(out / f"{read.name}.h5"))
        assert (said["samples"], said["duration_s"]) == (len(error_n), read.duration_s)
        assert said["max_depth_m"] == read.position_m.max() < 0.011
        assert said["max_force_n"] == read.force_n.max()
        assert (read.source, read.dt_s, read.zero) == (url, 0.001, "none")
        assert profile.metadata.items() <= read.details["command"].items()
    assert max(r["max_depth_m"] for r in answer["recordings"]) == pytest.approx(0.0104, rel=0.02)


def test_the_seed_draws_commands_and_noise(tmp_path, short):
    def recorded(number, seed):
        out = tmp_path / f"{number}"
        arguments = ("--device", "sim://dragon-skin-10", "--protocol", short, "--out", out)
        assert run(*arguments, "--seed", seed).exit_code == 0
        return [r.content_hash for r in read_recordings([out])]

    one, same, other = (recorded(number, seed) for number, seed in enumerate((1, 1, 2)))
    assert one == same and set(one).isdisjoint(other)


def test_nothing_is_overwritten(tmp_path, short):
    arguments = ["--device", "sim://dragon-skin-10", "--protocol", short, "--out", tmp_path / "o"]
    assert run(*arguments).exit_code == 0
    second = next(iter(sorted((tmp_path / "o").iterdir(), reverse=True)))
    before = {file: file.read_bytes() for file in (tmp_path / "o").iterdir()}
    min(before).unlink()
    result = run(*arguments)
    assert isinstance(result.exception, UsageError) and str(second) in str(result.exception)
    assert [*(tmp_path / "o").iterdir()] == [second] and second.read_bytes() == before[second]
