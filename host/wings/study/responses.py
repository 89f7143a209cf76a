"""What people answered: one row a trial that counts, with the names behind the blinding codes."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from springpot import DataError
from springpot.host.wings.study.folder import KEY, StudyFolder
from springpot.host.wings.study.session.conduct import JOURNAL
from springpot.host.wings.study.session.journal import Line, read_lines
from springpot.host.wings.study.session.progress import DoneTrial, SessionProgress, is_correct


@dataclass(frozen=True)
class Response:
    """One finished trial.

    session: 0 is practice. number: of the trial in its session, from 1. pair: index into
    `Study.pair`. shown: names of the stimuli in the slots, left to right (of abx: A, B, X).
    swapped: whether the pair's right stimulus was in the first slot. answer: similarity: the
    number; constant, staircase, quest+: "left" or "right", the slot that was chosen; abx: "A" or
    "B"; same-different: "same" or "different". correct: of the methods that know; None of
    similarity. seconds: from shown to answered. presses: of all slots; deepest_m, fastest_mps: in
    contact. warnings: that were given. log: the trial's rows, None if there is no device.
    """

    participant: str
    session: int
    number: int
    attempt: int
    pair: int
    shown: tuple[str, ...]
    swapped: bool
    answer: float | str
    correct: bool | None
    seconds: float
    presses: int
    deepest_m: float
    fastest_mps: float
    warnings: int
    log: Path | None


@dataclass(frozen=True)
class Reply:
    """One answer to a question at the end; question: index into `Study.question`."""

    participant: str
    question: int
    answer: str


def read_responses(folder: StudyFolder) -> tuple[list[Response], list[Reply]]:
    """Read trials that count and replies, by participant, session and time; opens the key.

    Practice is session 0. Raises DataError where a journal is damaged or of another study.
    """
    responses: list[Response] = []
    replies: list[Reply] = []
    for participant in folder.participants:
        for session in range(folder.study.sessions + 1):
            place = folder.session_folder(participant, session)
            if not (place / JOURNAL).exists():
                continue
            lines = read_lines(place / JOURNAL)
            _require_of(folder, place / JOURNAL, lines)
            progress = SessionProgress(folder, participant, session)
            for done in progress.done(lines):
                responses.append(_response(folder, participant, session, done, place))
            replies += [Reply(participant, line["question"], line["answer"])
                        for line in lines if line["step"] == "reply"]  # fmt: skip
    return responses, replies


def _require_of(folder: StudyFolder, file: Path, lines: list[Line]) -> None:
    digest = folder.key.digest
    for line in lines:
        if line["step"] in ("session", "resumed"):
            if line["study"] != folder.hash:
                raise DataError(f"{file}: of another plan of this study: put it back where it was")
            if line["key"] != digest:
                raise DataError(f"{file}: {folder.path / KEY} is not the key it was made with")


def _response(
    folder: StudyFolder, participant: str, session: int, done: DoneTrial, place: Path
) -> Response:
    trial, answered = done.trial, done.answered
    details: dict[str, Any] = done.lines[-1]
    log = place / details["log"] if details.get("log") else None
    return Response(
        participant=participant,
        session=session,
        number=trial.number,
        attempt=trial.attempt,
        pair=trial.pair,
        shown=trial.shown,
        swapped=trial.swapped,
        answer=answered["answer"],
        correct=is_correct(folder.study, trial, answered["answer"]),
        seconds=float(answered["seconds"]),
        presses=int(details.get("presses", 0)),
        deepest_m=float(details.get("deepest_m", 0.0)),
        fastest_mps=float(details.get("fastest_mps", 0.0)),
        warnings=int(details.get("warnings", 0)),
        log=log,
    )
