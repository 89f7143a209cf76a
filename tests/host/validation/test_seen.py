"""Validation on training recordings is noticed by their samples, and said before any figure."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from support.in_process import spring
from support.small import press, recording, small_fit, training

from springpot import Recording, check_recordings
from springpot.host.validation.seen import seen_by, seen_line
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import write_recording

NEW = recording("new", press(1.7, 0.01))
TOLD = "2 of 3 of these recordings are training data: the error is not that of new ones"


def renamed(item: Recording) -> Recording:
    return replace(item, name=f"my-{item.name}", source="another folder")


def cut(item: Recording) -> Recording:
    return replace(item, position_m=item.position_m[10:], force_n=item.force_n[10:])


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model, its C, and three recordings: two of the training under another name."""
    folder = tmp_path_factory.mktemp("seen")
    mixed = (NEW, renamed(training()[0]), renamed(training()[5]))
    for name, items in (("training", training()), ("mixed", mixed)):
        (folder / name).mkdir()
        for item in items:
            write_recording(folder / name / f"{item.name}.h5", item)
    (folder / "scene.toml").write_text('schema = 1\nname = "seen"\nmodel = "m.spm"\n')
    return folder


@pytest.mark.slow
def test_train_validate_and_report_say_it_first(job: Path) -> None:
    train = ["train", job / "training", "--model", "hammerstein", "--out", job / "m.spm",
             "--validate", job / "mixed"]  # fmt: skip
    assert json.loads(spring(*train, "--json").stdout)["seen"] == 2
    first = " ".join(spring(*train).stdout.split())
    assert first.startswith(f"training data {TOLD[:40]}")
    emitted = spring("emit", "--scene", job / "scene.toml", "--out", job / "c",
                     "--recording", job / "mixed")  # fmt: skip
    assert emitted.returncode == 0
    assert emitted.stderr.startswith(TOLD)
    validate = ["validate", job / "c", "--recording", job / "mixed"]
    assert json.loads(spring(*validate, "--json").stdout)["seen"] == 2
    shown = " ".join(spring(*validate).stdout.split())
    assert shown.startswith(f"training data {TOLD[:40]}")
    assert spring("report", job / "c").returncode == 0
    page = (job / "c/report.html").read_text()
    said = page.index("2 of these recordings are training data")
    assert said < page.index("<h2>Error</h2>")


@pytest.mark.few(1)
@pytest.mark.parametrize("smooth_s", [0.0, 0.025])
def test_a_name_hides_nothing_and_a_cut_cannot_be_known(smooth_s: float) -> None:
    """Also where the fit saw the recordings smoothed."""
    model = fit_model("hammerstein", "m", training(), FitOptions(smooth_s=smooth_s)).model
    assert seen_by(model, [training()[0], renamed(training()[1]), NEW]) == 2
    assert seen_by(model, [cut(training()[0])]) == 0


def test_a_model_that_does_not_say_is_not_called_unseen() -> None:
    model = replace(small_fit().model, provenance={})
    assert seen_by(model, [NEW]) is None
    assert "does not say" in seen_line(None, 1)


def test_two_training_recordings_of_one_name_are_both_seen() -> None:
    """Folders of two days may hold the same names."""
    twins = [replace(item, name="press") for item in training()[:2]]
    model = fit_model("hammerstein", "x", [*twins, *training()[2:4]], FitOptions()).model
    assert seen_by(model, twins) == 2
    assert len(check_recordings(twins).recordings) == 2
    speeds = {figures["max_speed_mps"] for figures in check_recordings(twins).recordings}
    assert len(speeds) == 2
