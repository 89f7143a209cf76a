"""A session goes on where it was, whatever ended it: no trial lost, doubled or out of order."""

import io
import itertools
from pathlib import Path

import pytest
from support.in_process import spring
from support.scripted_presenter import ScriptedPresenter, journals, killed_at, run_whole
from support.small_study import (
    SOFT,
    planned,
    real_stimulus,
    real_study,
    scene_stimulus,
    study_text,
)

from springpot.codegen.errors import DataError, UsageError
from springpot.host.wings.study.folder import StudyFolder, read_folder
from springpot.host.wings.study.responses import Response, read_responses
from springpot.host.wings.study.schedule import fixed_trials
from springpot.host.wings.study.session.conduct import JOURNAL, conduct, next_session
from springpot.host.wings.study.session.journal import read_lines


def answered(folder: StudyFolder, participant: str = "01") -> list[Response]:
    return [one for one in read_responses(folder)[0] if one.participant == participant]


def require_whole(folder: StudyFolder) -> None:
    """Every planned trial counts once, in its order."""
    for session in range(1, folder.study.sessions + 1):
        done = [one for one in answered(folder) if one.session == session]
        expected = fixed_trials(folder.study, 1, session)
        assert [one.number for one in done] == [trial.number for trial in expected]
        assert [one.pair for one in done] == [trial.pair for trial in expected]


def require_survives(folder: StudyFolder, step: int, before: bool) -> bool:
    """Kill it there and go on; whether there was such a step."""
    killed = killed_at(step, lambda: run_whole(folder, "01"), before)
    run_whole(folder, "01")
    require_whole(folder)
    for file in journals(folder.path):
        (folder.path / file).unlink()
    return killed


def test_killed_at_every_step_of_a_short_study(tmp_path: Path) -> None:
    folder = planned(tmp_path, real_study(2, sessions=2, sections={"question": [{"text": "?"}]}))
    for before in (False, True):
        steps = next(k for k in itertools.count(1) if not require_survives(folder, k, before)) - 1
        assert steps == 2 * (2 + 2 * 4) + 1  # a beginning and an end, four lines a trial, a reply


def test_a_voided_trial_comes_again_at_the_end(tmp_path: Path) -> None:
    folder = planned(tmp_path, real_study(4))
    presenter = ScriptedPresenter(voids=(2,))
    counts: dict[str, int] = {}
    conduct(folder, "01", 1, presenter, counts)
    assert [trial.number for trial in presenter.shown] == [1, 2, 3, 4, 2]
    assert [trial.attempt for trial in presenter.shown] == [1, 1, 1, 1, 2]
    assert presenter.shown[1].codes == presenter.shown[4].codes
    assert presenter.shown[4].log.name == "trial-002-2.h5"
    assert counts == {"done": 4, "void": 1}
    assert [one.number for one in answered(folder)] == [1, 3, 4, 2]


def test_sessions_follow_each_other_and_end(tmp_path: Path) -> None:
    folder = planned(tmp_path, real_study(2, sessions=2, practice=1))
    found = []
    while (session := next_session(folder, "02")) is not None:
        found.append(session)
        conduct(folder, "02", session, ScriptedPresenter())
    assert found == [0, 1, 2]
    with pytest.raises(UsageError, match="over"):
        conduct(folder, "02", 2, ScriptedPresenter())
    with pytest.raises(UsageError, match="no participant '3': the plan has 01 to 02"):
        next_session(folder, "3")


def test_another_key_is_refused(tmp_path: Path) -> None:
    folder = planned(tmp_path, real_study(2))
    run_whole(folder, "01")
    key = folder.path / "key.json"
    key.write_text(key.read_text().replace('"R1"', '"R9"'))
    with pytest.raises(DataError, match="not the key it was made with"):
        read_responses(folder)
    key.unlink()
    with pytest.raises(DataError, match="take it from your backup"):
        read_responses(read_folder(folder.path))


def test_adaptive_sessions_end_by_themselves(tmp_path: Path) -> None:
    levels = [{**real_stimulus(f"b{k}"), "level": 1.0 + k} for k in (1, 2, 3)]
    stimuli = [{**real_stimulus("a"), "level": 1.0}, *levels]
    pairs = [{"left": "a", "right": f"b{k}"} for k in (1, 2, 3)]
    for method, section in (("staircase", {"trials": 9}), ("quest+", {"trials": 7})):
        place = tmp_path / method
        place.mkdir()
        key = method.rstrip("+")
        text = study_text(method, stimuli, pairs, sections={key: section})
        folder = planned(place, text)
        assert killed_at(14, lambda folder=folder: run_whole(folder, "01", "left"), before=False)
        run_whole(folder, "01", "left")
        found = answered(folder)
        assert [one.number for one in found] == list(range(1, section["trials"] + 1))
        lines = read_lines(folder.session_folder("01", 1) / JOURNAL)
        assert [line["step"] for line in lines].count("resumed") == 1


@pytest.mark.parametrize(
    ("real", "device", "said"),
    [
        (True, (), "run it in a terminal"),
        (True, ("--device", "sim://x"), "leave --device out"),
        (False, (), "give the device, --device URL"),
    ],
)
def test_wrong_use_is_refused(
    tmp_path: Path, real: bool, device: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO())
    simulated = study_text("similarity", [scene_stimulus("a")], [{"left": "a", "right": "a"}])
    folder = planned(tmp_path, real_study(2) if real else simulated, 1, SOFT)
    done = spring("study", "run", folder.path, "--participant", "01", *device)
    assert done.returncode == 2
    assert said in done.stderr
