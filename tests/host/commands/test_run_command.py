"""What `run` says at its end, and what `validate` says of its log."""

from pathlib import Path

import pytest
from support.in_process import spring
from support.small import model_file, press, recording, scene

from springpot.host.emission.emission import emit
from springpot.trainer.recordings.recording_file import write_recording


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    base = tmp_path_factory.mktemp("run")
    emit(scene(), model_file(base), base / "c")
    write_recording(base / "press.h5", recording("press", press(2.0)))
    return base


def test_why_it_stopped_is_told_once(folder: Path) -> None:
    device = f"replay://{folder / 'press.h5'}"
    done = spring("run", "--scene", folder / "c", "--device", device)
    assert done.returncode == 0, done.stderr
    assert (done.stdout + done.stderr).count("the replay has no more samples") == 1
    stopped = spring("run", "--scene", folder / "c", "--device", device, "--max-depth-mm", 1)
    assert stopped.returncode == 1
    assert (stopped.stdout + stopped.stderr).count("mm deep, the limit is 1 mm") == 1
    assert stopped.stderr.splitlines()[-1].startswith("springpot: stopped: the tool came")


def test_a_log_is_compared_with_the_c_and_leaves_the_validation_alone(folder: Path) -> None:
    press_file, log = folder / "press.h5", folder / "felt.h5"
    validated = spring("validate", folder / "c", "--recording", press_file)
    assert "mean error" in validated.stdout
    noted = " ".join(validated.stdout.split())
    assert "ticks with notes resync 1 (history begins anew here)" in noted
    before = (folder / "c" / "validation" / "result.json").read_text()
    device = f"replay://{press_file}"
    spring("run", "--scene", folder / "c", "--device", device, "--log", log)
    felt = spring("validate", folder / "c", "--recording", log)
    assert felt.returncode == 0, felt.stderr
    words = " ".join(felt.stdout.split())
    assert "what was felt is what the model says" in words
    assert "not with a measured object" in words
    assert "RMSE" not in words
    assert (folder / "c" / "validation" / "result.json").read_text() == before
