"""Each error beside the noise floor and the just noticeable difference."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring
from support.small import press, recording, training

from springpot.host.metrics import accuracy
from springpot.host.validation.error_ratios import error_ratios, floor_words
from springpot.trainer.recordings.quality.noise_floor import NoiseFloor
from springpot.trainer.recordings.recording_file import write_recording

KEYS = {"noise_floor_n", "noise_floor_from", "noise_floor", "error_per_floor", "error_per_jnd"}
ERROR = accuracy([np.array([1.0, 10.0])], [np.array([1.1, 10.5])])


def test_the_jnd_is_that_of_each_force() -> None:
    """Of 1 N it is 0.2 N, of 10 N 1 N: both errors are half of it."""
    assert ERROR.error_per_jnd == pytest.approx(0.5)


def test_a_floor_of_nothing_divides_nothing() -> None:
    none = error_ratios(ERROR, NoiseFloor(0.0, "repeats", "from 2 repeats of one press"))
    assert none["error_per_floor"] is None
    assert floor_words(none) == "0 N, from 2 repeats of one press: no ratio"
    unknown = error_ratios(ERROR, NoiseFloor(None, None, "why"))
    assert unknown["error_per_floor"] is None
    assert floor_words(unknown) == "not known: why"
    known = error_ratios(ERROR, NoiseFloor(0.1, "repeats", "from 2 repeats of one press"))
    assert known["error_per_floor"] == pytest.approx(10 * ERROR.rmse_n)


def test_train_gives_both(tmp_path: Path) -> None:
    noise = np.random.default_rng(0)
    for folder, items in (("rec", training()), ("new", [recording("new", press(2.0))])):
        (tmp_path / folder).mkdir()
        for item in items:
            for again in ("a", "b"):
                force_n = item.force_n + noise.normal(0, 0.02, len(item.force_n))
                name = f"{item.name}{again}"
                write_recording(tmp_path / folder / f"{name}.h5",
                                replace(item, name=name, force_n=force_n))  # fmt: skip
    train = ["train", tmp_path / "rec", "--model", "hammerstein", "--out", tmp_path / "m.spm",
             "--validate", tmp_path / "new"]  # fmt: skip
    trained = json.loads(spring(*train, "--json").stdout)
    assert set(trained) >= KEYS
    assert trained["noise_floor_n"] == pytest.approx(0.02, rel=0.1)
    assert trained["noise_floor"] == f"from 2 repeats of each of {len(training()) + 1} presses"
    assert trained["error_per_floor"] == pytest.approx(trained["rmse_n"] / trained["noise_floor_n"])
    shown = " ".join(spring(*train).stdout.split())
    assert f"error / noise floor {trained['error_per_floor']:.3g} (floor" in shown
    assert f"error / JND {trained['error_per_jnd']:.3g}, rms" in shown
