"""One session of a study: trial after trial, each step on the disk before the next is shown."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

from springpot import SpringpotError, UsageError
from springpot.host.wings.study.definition import Question, Stimulus
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.session.journal import StudyJournal, read_lines
from springpot.host.wings.study.session.progress import INTERRUPTED, SessionProgress, TrialToShow

JOURNAL = "trials.jsonl"
Record = Callable[..., None]  # a step and what is known of it, into the journal


class SessionStoppedError(SpringpotError):
    """The experimenter ended the session: the same command goes on with it."""


@dataclass(frozen=True)
class PresentedTrial:
    """What whoever shows a trial needs to know. of: trials in the session, where that is known.

    codes, stimuli: of the slots, left to right. log: the file for its rows.
    """

    number: int
    attempt: int
    of: int | None
    codes: tuple[str, ...]
    stimuli: tuple[Stimulus, ...]
    log: Path


@dataclass(frozen=True)
class TrialOutcome:
    """answer: None if the experimenter voided the trial. details: for the line `done`."""

    answer: float | str | None
    details: Mapping[str, Any]


class Presenter(Protocol):
    """Who shows trials and questions: a device with two screens, or a simulated person."""

    def metadata(self) -> dict[str, Any]:
        """Return what the session's first line says of the device."""
        ...

    def trial(self, trial: PresentedTrial, record: Record) -> TrialOutcome:
        """Show one trial; `record` takes the steps pressed and answered."""
        ...

    def question(self, number: int, of: int, question: Question) -> str:
        """Ask one question at the end."""
        ...

    def finished(self, session: int) -> None:
        """Say that the session is over."""
        ...


def next_session(folder: StudyFolder, participant: str) -> int | None:
    """Return the first session that is not over; None: all are. 0 is practice."""
    folder.number(participant)
    for session in range(0 if folder.study.practice else 1, folder.study.sessions + 1):
        file = folder.session_folder(participant, session) / JOURNAL
        if not file.exists() or not any(line["step"] == "end" for line in read_lines(file)):
            return session
    return None


def conduct(
    folder: StudyFolder,
    participant: str,
    session: int,
    presenter: Presenter,
    counts: dict[str, int] | None = None,
) -> None:
    """Go on with a session until it is over. counts: adds up trials "done" and "void".

    Raises SessionStoppedError where the experimenter stops, DeviceError where the device fails: all
    that was done counts, and the trial that was open comes again.
    """
    place = folder.session_folder(participant, session)
    place.mkdir(parents=True, exist_ok=True)
    with StudyJournal(place / JOURNAL) as journal:
        if any(line["step"] == "end" for line in journal.lines):
            raise UsageError(f"{place}: this session is over: nothing is left to show")
        sitting = _Sitting(folder, participant, session, presenter, journal)
        sitting.begin()
        counts = {} if counts is None else counts
        progress = SessionProgress(folder, participant, session)
        while (trial := progress.next_trial(journal.lines)) is not None:
            step = "done" if sitting.counts(trial, progress.trials_in_all()) else "void"
            counts[step] = counts.get(step, 0) + 1
        if session == folder.study.sessions:
            sitting.ask()
        journal.write("end", at=_now())
        presenter.finished(session)


@dataclass(frozen=True, eq=False)
class _Sitting:
    """One participant before one presenter, with the session's journal."""

    folder: StudyFolder
    participant: str
    session: int
    presenter: Presenter
    journal: StudyJournal

    def begin(self) -> None:
        """Write the first line of a session, or of its going on; void a trial that was open."""
        lines, write = self.journal.lines, self.journal.write
        step = "resumed" if lines else "session"
        if lines and lines[-1]["step"] in ("shown", "pressed", "answered"):
            write("void", trial=lines[-1]["trial"], reason=INTERRUPTED)
        write(
            step, at=_now(), study=self.folder.hash, key=self.folder.key.digest,
            participant=self.participant, session=self.session, springpot=version("springpot"),
            **self.presenter.metadata(),
        )  # fmt: skip

    def counts(self, trial: TrialToShow, of: int | None) -> bool:
        """Show a trial; return whether it counts, or the experimenter voided it."""
        write, key, study = self.journal.write, self.folder.key, self.folder.study
        codes = tuple(key.code(self.participant, name) for name in trial.shown)
        stimuli = tuple(study.stimulus_of(name) for name in trial.shown)
        attempt = "" if trial.attempt == 1 else f"-{trial.attempt}"
        place = self.folder.session_folder(self.participant, self.session)
        log = place / f"trial-{trial.number:03d}{attempt}.h5"
        write("shown", trial=trial.number, attempt=trial.attempt, codes=list(codes), at=_now())
        begin_s = time.monotonic()

        def record(step: str, **content: Any) -> None:
            seconds = round(time.monotonic() - begin_s, 3)
            write(step, trial=trial.number, seconds=seconds, **content)

        presented = PresentedTrial(trial.number, trial.attempt, of, codes, stimuli, log)
        outcome = self.presenter.trial(presented, record)
        if outcome.answer is None:
            write("void", trial=trial.number, reason="by the experimenter", **outcome.details)
            return False
        write("done", trial=trial.number, **outcome.details)
        return True

    def ask(self) -> None:
        """Ask the questions at the end that have no reply yet."""
        asked = {line["question"] for line in self.journal.lines if line["step"] == "reply"}
        questions = self.folder.study.question
        for k, question in enumerate(questions):
            if k not in asked:
                answer = self.presenter.question(k + 1, len(questions), question)
                self.journal.write("reply", question=k, answer=answer)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
