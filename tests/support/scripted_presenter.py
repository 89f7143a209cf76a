"""A presenter without device or person: answers at once, and may die or void where a test says."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

from springpot.host.wings.study.definition import Question
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.session.conduct import (
    PresentedTrial,
    Record,
    TrialOutcome,
    conduct,
    next_session,
)
from springpot.host.wings.study.session.journal import StudyJournal


class ScriptedPresenter:
    """Gives one answer to everything; `voids`: trials that are voided the first time."""

    def __init__(self, voids: tuple[int, ...] = (), answer: float | str = 50.0) -> None:
        self.answer = answer
        self.voids = list(voids)
        self.shown: list[PresentedTrial] = []

    def metadata(self) -> dict[str, Any]:
        return {"device": None}

    def trial(self, trial: PresentedTrial, record: Record) -> TrialOutcome:
        self.shown.append(trial)
        record("pressed", presses=[1, 1])
        if trial.number in self.voids:
            self.voids.remove(trial.number)
            return TrialOutcome(None, {})
        record("answered", answer=self.answer)
        return TrialOutcome(self.answer, {"presses": 2})

    def question(self, number: int, of: int, question: Question) -> str:
        del number, of
        return question.choices[0] if question.choices else "none"

    def finished(self, session: int) -> None:
        del session


def run_whole(folder: StudyFolder, participant: str, answer: float | str = 50.0) -> None:
    """All sessions that are left of a participant."""
    while (session := next_session(folder, participant)) is not None:
        conduct(folder, participant, session, ScriptedPresenter(answer=answer))


def killed_at(step: int, work: Callable[[], None], before: bool) -> bool:
    """Run `work` in a process that is killed at the so manieth line; whether it came to that.

    before: when nothing of the line is written yet; else when it is on the disk.
    """
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        if not os.WIFSIGNALED(status):
            assert os.waitstatus_to_exitcode(status) == 0, "the work failed, and was not killed"
        return os.WIFSIGNALED(status)
    write, written = StudyJournal.write, 0

    def counted(journal: StudyJournal, name: str, **content: Any) -> None:
        nonlocal written
        written += 1
        if before and written == step:
            os.kill(os.getpid(), signal.SIGKILL)
        write(journal, name, **content)
        if written == step:
            os.kill(os.getpid(), signal.SIGKILL)

    try:
        with patch.object(StudyJournal, "write", counted):
            work()
    except BaseException:
        os._exit(1)
    os._exit(0)


def journals(folder: Path) -> dict[str, bytes]:
    """All journals below a folder."""
    return {str(file.relative_to(folder)): file.read_bytes()
            for file in sorted(folder.rglob("trials.jsonl"))}  # fmt: skip
