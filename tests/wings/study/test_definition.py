"""Study files: what is wrong is named, with what to do; what is planned is frozen."""

from pathlib import Path

import pytest
from support.small_study import (
    HARD,
    SOFT,
    planned,
    real_stimulus,
    real_study,
    scene_stimulus,
    steps_study,
    study_text,
    write_scenes,
)

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.scene import Runtime, Scene
from springpot.host.emission.scene_file import write_scene
from springpot.host.wings.study.folder import copy_study, read_folder, write_study
from springpot.host.wings.study.study_file import read_study

A, B = real_stimulus("a"), real_stimulus("b")
PAIR = {"left": "a", "right": "b"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("schema = 1\n[[pair", "not a study file"),
        (study_text("similarity", [A], [PAIR]), "pair 1: no stimulus 'b': known here are a"),
        (study_text("similarity", [A, A], [PAIR]), "'a': twice"),
        (study_text("similarity", [A, {"name": "b"}], [PAIR]), "either scene = ... or real"),
        (study_text("similarity", [A, {**B, "scene": "x"}], [PAIR]), "either scene = ... or real"),
        (study_text("similarity", [A, {**B, "stiffer": 2.0}], [PAIR]), "stiffer is of a scene"),
        (study_text("similarity", [A, B], []), "pair"),
        (study_text("rating", [A, B], [PAIR]), "method"),
        (study_text("similarity", [A, B], [{**PAIR, "side": "both"}]),
         "pair.0.side: no such key: known here are left, right, repeats, sides, factors, series"),
        (study_text("similarity", [A, B], [{**PAIR, "repeats": 2}], order="williams"),
         "williams shows every pair once a session"),
        (study_text("abx", [A, B], [{"left": "a", "right": "a"}]), "'a' on both sides"),
        (study_text("staircase", [A, B], [PAIR]), "at least three pairs"),
        (study_text("constant", [A, B], [PAIR, {"left": "b", "right": "a"}]), "one standard"),
        (study_text("similarity", [A, B], [{**PAIR, "factors": {"x": "1"}},
                                           {**PAIR, "factors": {"y": "1"}}]), "the same ones"),
        (study_text("similarity", [A, B], [{**PAIR, "factors": dict.fromkeys("xyz", "1")}]),
         "at most two"),
        (study_text("similarity", [A, B], [PAIR], sessions=0), "sessions"),
        (study_text("similarity", [A, B], [PAIR], sections={"exclude": {"repeat_sd": 3.0}}),
         "exclude.repeat_sd: no such key: known here are repeat_sd_above"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(UsageError) as refusal:
        read_study(tmp_path / "study.toml")
    assert said in str(refusal.value)
    assert str(refusal.value).startswith(f"{tmp_path}/study.toml: ")


def test_a_planned_study_is_frozen(tmp_path: Path) -> None:
    study = planned(tmp_path, real_study(), 12)
    assert study.participants[0] == "01"
    assert study.participants[-1] == "12"
    definition = study.path / "study.toml"
    definition.write_text(definition.read_text().replace("object 1", "object one"))
    with pytest.raises(DataError, match="changed since the study was planned"):
        read_folder(study.path)


def test_a_planned_study_is_never_overwritten(tmp_path: Path) -> None:
    study = planned(tmp_path, real_study())
    before = (study.path / "key.json").read_bytes()
    with pytest.raises(UsageError, match="never overwritten"):
        write_study(tmp_path / "study.toml", 3, study.path, lambda _done, _of: None)
    assert (study.path / "key.json").read_bytes() == before


def test_scenes_are_frozen_with_the_study(tmp_path: Path) -> None:
    study = planned(tmp_path, steps_study("constant", 1.25), 2, SOFT)
    assert {scene.rate_hz for scene in study.scenes.values()} == {1000.0}
    standard, stiffer = study.scenes["standard"], study.scenes["times 1.25"]
    assert stiffer.max_depth_m == pytest.approx(standard.max_depth_m / 1.25)
    again = copy_study(study, 5, tmp_path / "again")
    assert {scene.hash for scene in again.scenes.values()} == {
        scene.hash for scene in study.scenes.values()
    }
    assert again.key.codes.keys() == {"01", "02", "03", "04", "05"}


def test_scenes_that_could_not_share_a_loop_are_refused(tmp_path: Path) -> None:
    text = study_text("similarity", [scene_stimulus("a"), scene_stimulus("b", HARD)], [PAIR])
    write_scenes(tmp_path, SOFT, HARD)
    (tmp_path / "study.toml").write_text(text)
    for runtime in (Runtime(rate_hz=2000.0), Runtime(number="float64")):
        write_scene(tmp_path / f"{HARD}.toml", Scene(1, "hard", f"{HARD}.spm", runtime=runtime))
        with pytest.raises(UsageError, match="share one loop"):
            write_study(tmp_path / "study.toml", 2, tmp_path / "plan", lambda _done, _of: None)
