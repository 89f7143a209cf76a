"""What the experimenter is told and can do; what the participant sees meanwhile."""

import contextlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.small_study import planned, real_study
from support.study_participant import ScriptedParticipant

from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.session.conduct import JOURNAL, SessionStoppedError, conduct
from springpot.host.wings.study.session.experimenter import Experimenter, TrialVoidedError
from springpot.host.wings.study.session.journal import read_lines
from springpot.host.wings.study.session.presenter import DevicePresenter
from springpot.host.wings.study.session.screen import ParticipantScreen


class ScriptedKeys:
    """Enter at every tenth look; `others`: what is told -> another key, once."""

    def __init__(self, **others: str) -> None:
        self.others, self.told, self.looks = others, list[str](), 0

    def tell(self, line: str) -> None:
        self.told.append(line)

    def pressed(self) -> str:
        for text in list(self.others):
            if self.told and text in self.told[-1].replace(" ", "_"):
                return self.others.pop(text)
        self.looks += 1
        return "" if self.looks % 10 else "\n"


@pytest.fixture
def screen() -> Iterator[ParticipantScreen]:
    with ParticipantScreen() as found:
        yield found


def run_session(folder: StudyFolder, screen: ParticipantScreen, keys: ScriptedKeys) -> list[str]:
    """One session with a scripted participant; everything that was on the screen."""
    presenter = DevicePresenter(folder, None, screen, Experimenter(keys, keys.tell))
    participant = ScriptedParticipant(screen.address)
    presenter.welcome(1)
    try:
        conduct(folder, "01", 1, presenter)
    finally:
        screen.__exit__(None, None, None)
        participant.join()
    return participant.seen


def steps(folder: StudyFolder) -> list[tuple[str, int | None]]:
    lines = read_lines(folder.session_folder("01", 1) / JOURNAL)
    return [(line["step"], line.get("trial")) for line in lines]


def test_a_session_of_real_objects(tmp_path: Path, screen: ParticipantScreen) -> None:
    folder = planned(tmp_path, real_study(2, sections={"question": [{"text": "Why?"}]}))
    keys = ScriptedKeys()
    seen = run_session(folder, screen, keys)
    assert [step for step, _ in steps(folder)] == [
        "session", *["shown", "pressed", "answered", "done"] * 2, "reply", "end",
    ]  # fmt: skip
    told = "\n".join(keys.told)
    for name, sticker in folder.key.stickers.items():
        assert f"put {sticker} under the tool; then press Enter" in told
        assert name not in told
        assert not any(name in text or sticker in text for text in seen)
    assert any("the experimenter changes the object" in text for text in seen)
    assert any("You have finished" in text for text in seen)


def test_v_voids_a_trial_and_it_comes_again(tmp_path: Path, screen: ParticipantScreen) -> None:
    folder = planned(tmp_path, real_study(2))
    keys = ScriptedKeys(Trial_1_of_2="v")
    run_session(folder, screen, keys)
    done = [trial for step, trial in steps(folder) if step == "done"]
    assert done == [2, 1]
    assert "Trial 1 of 2: void; it comes again at the end" in keys.told
    assert "Trial 1 of 2, attempt 2" in keys.told


def test_q_stops_and_the_same_command_goes_on(tmp_path: Path, screen: ParticipantScreen) -> None:
    folder = planned(tmp_path, real_study(2))
    with pytest.raises(SessionStoppedError, match="the same command goes on"):
        run_session(folder, screen, ScriptedKeys(Trial_2_of_2="q"))
    with ParticipantScreen() as another:
        keys = ScriptedKeys()
        run_session(folder, another, keys)
    assert "Trial 2 of 2, attempt 2" in keys.told
    assert [trial for step, trial in steps(folder) if step == "done"] == [1, 2]


def test_r_resets_and_no_other_key_does() -> None:
    resets: list[str] = []
    for key in map(chr, range(128)):
        keys = SimpleNamespace(pressed=lambda key=key: key)
        experimenter = Experimenter(keys, reset=partial(resets.append, key))
        with contextlib.suppress(TrialVoidedError, SessionStoppedError):
            experimenter.look()
    assert resets == ["r"]
