"""`springpot predict`: the model's force beside the measured one, in a file that others read."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring
from support.small import DT_S, model_file, passive_model, recording, training

from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.recording_file import write_recording


@pytest.fixture
def job(tmp_path: Path) -> Path:
    model_file(tmp_path)
    (tmp_path / "rec").mkdir()
    for item in training()[:2]:
        write_recording(tmp_path / "rec" / f"{item.name}.h5", item)
    return tmp_path


def predicted(job: Path, *arguments: str) -> tuple[int, str, str]:
    result = spring("predict", str(job / "model.spm"), *arguments, "--out", str(job / "out"))
    return result.returncode, result.stdout, result.stderr


def test_the_force_never_pulls_and_the_error_is_that_of_the_files(job: Path) -> None:
    status, printed, _ = predicted(job, str(job / "rec"), "--json")
    assert status == 0
    result = json.loads(printed)
    errors = []
    for file, item in zip(result["files"], training()[:2], strict=True):
        table = np.genfromtxt(file, delimiter=",", names=True)
        np.testing.assert_array_equal(table["force_N"], item.force_n)
        force_n = np.maximum(predict_n(passive_model(), item), 0.0)
        np.testing.assert_allclose(table["predicted_N"], force_n, atol=1e-6)
        errors.append(table["predicted_N"] - item.force_n)
    assert result["rmse_n"] == pytest.approx(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def test_deeper_presses_are_said_and_millimetres_refused(job: Path) -> None:
    deep = passive_model().trained.max_m * np.linspace(0.0, 2.0, 60)
    write_recording(job / "deep.h5", recording("deep", deep))
    status, _, err = predicted(job, str(job / "deep.h5"))
    assert status == 0 and "deep: goes to 2 times the trained depth" in err
    write_recording(job / "mm.h5", recording("mm", 20.0 * deep))
    status, _, err = predicted(job, str(job / "mm.h5"))
    assert status == 3 and "give positions in metres" in err


def test_what_is_there_is_kept_and_another_rate_refused(job: Path) -> None:
    assert predicted(job, str(job / "rec"))[0] == 0
    status, _, err = predicted(job, str(job / "rec"))
    assert status == 2 and "exists already" in err
    other = replace(training()[0], name="slow", dt_s=2 * DT_S)
    write_recording(job / "slow.h5", other)
    status, _, err = predicted(job, str(job / "slow.h5"))
    assert status == 3 and "--resample-hz" in err
