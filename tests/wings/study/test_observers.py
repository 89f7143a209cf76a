"""Simulated people press the emitted C: what they find is what their noise implies."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small_study import (
    SOFT,
    planned,
    real_stimulus,
    scene_stimulus,
    study_text,
)
from support.study.same_forces import require_same_forces

from springpot.codegen.errors import UsageError
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.wings.study.observers.observer import (
    FeltPress,
    Observer,
    answer,
)
from springpot.host.wings.study.observers.simulate import simulate
from springpot.host.wings.study.report.page import write_study_report
from springpot.host.wings.study.responses import read_responses
from springpot.trainer.recordings.recording_file import read_recording

EXACT = Observer(weber=0.10)
TRIALS = 20_000


def linear_press(stiffness_npm: float) -> FeltPress:
    position_m = np.concatenate((np.linspace(-1e-3, 5e-3, 300), np.linspace(5e-3, -1e-3, 300)))
    return FeltPress(position_m, stiffness_npm * np.maximum(position_m, 0))


def normal(z: float) -> float:
    return 0.5 * (1 + math.erf(z / math.sqrt(2)))


def study_of(method: str) -> str:
    stimuli = [scene_stimulus("a"), scene_stimulus("b", stiffer=1.25)]
    return study_text(method, stimuli, [{"left": "a", "right": "b"}])


@pytest.mark.parametrize(("factor", "lapse"), [(1.05, 0.0), (1.15, 0.2), (1.3, 0.0)])
def test_two_choices_follow_phi_of_d_prime(tmp_path: Path, factor: float, lapse: float) -> None:
    person = replace(EXACT, lapse=lapse)
    study = planned(tmp_path, study_of("constant"), 1, SOFT).study
    random = np.random.default_rng(4)
    presses = [linear_press(500.0), linear_press(500.0 * factor)]
    right = sum(answer(person, study, presses, random) == "right" for _ in range(TRIALS)) / TRIALS
    expected = lapse / 2 + (1 - lapse) * normal(math.log(factor) / person.sd / math.sqrt(2))
    assert abs(right - expected) < 4 * math.sqrt(expected * (1 - expected) / TRIALS)


def test_same_different_follows_its_criterion(tmp_path: Path) -> None:
    study = planned(tmp_path, study_of("same-different"), 1, SOFT).study
    random = np.random.default_rng(5)
    for factor in (1.0, 1.2):
        presses = [linear_press(500.0), linear_press(500.0 * factor)]
        found = sum(answer(EXACT, study, presses, random) == "same" for _ in range(TRIALS)) / TRIALS
        shift = math.log(factor) / EXACT.sd / math.sqrt(2)
        edge = EXACT.criterion / math.sqrt(2)
        expected = normal(edge - shift) - normal(-edge - shift)
        assert abs(found - expected) < 4 * math.sqrt(expected * (1 - expected) / TRIALS)


def test_ratings_fall_with_the_difference(tmp_path: Path) -> None:
    study = planned(tmp_path, study_of("similarity"), 1, SOFT).study
    random = np.random.default_rng(6)
    means = [
        np.mean([answer(EXACT, study, [linear_press(500.0), linear_press(500.0 * factor)], random)
                 for _ in range(2000)])
        for factor in (1.0, 1.3, 2.0, 10.0)
    ]  # fmt: skip
    assert means == sorted(means, reverse=True)
    assert means[0] > 75
    assert means[-1] < 15


def test_every_force_of_a_simulated_study_is_that_of_the_emitted_c(tmp_path: Path) -> None:
    stimuli = [scene_stimulus("a"), scene_stimulus("b", stiffer=1.5), real_stimulus("c")]
    pairs = [{"left": "a", "right": "b"}, {"left": "c", "right": "a"}]
    study = planned(tmp_path, study_text("similarity", stimuli, pairs, sessions=2), 1, SOFT)
    folder = simulate(study, 2, 1, tmp_path / "sim", lambda _done, _of: None).folder
    libraries = {
        name: SceneLibrary(folder.path / scene.folder) for name, scene in folder.scenes.items()
    }
    compared = 0
    for one in read_responses(folder)[0]:
        assert (one.log is not None) == (one.participant == "01")
        assert one.presses == 2
        if one.log is not None:
            scenes = [libraries.get(name) for name in one.shown]
            channels = read_recording(one.log).channels
            compared += require_same_forces(one.log.name, channels, scenes)
    assert compared > 5000
    page = Path(write_study_report(folder.path)["out"]).read_text()
    assert "Nobody was asked" in page


def test_a_real_object_needs_a_simulated_one(tmp_path: Path) -> None:
    stimuli = [scene_stimulus("a"), {"name": "b", "real": "a block"}]
    plan = planned(tmp_path, study_text("similarity", stimuli, [{"left": "a", "right": "b"}]), 1,
                   SOFT)  # fmt: skip
    with pytest.raises(UsageError, match="name the simulated one that stands for it"):
        simulate(plan, 2, 0, tmp_path / "sim", lambda _done, _of: None)
    assert not (tmp_path / "sim").exists()
