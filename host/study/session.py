"""One participant's session: trial after trial on the device, a rating, a row in a table."""

import sys
import time
from collections.abc import Sequence
from itertools import count
from pathlib import Path

import numpy as np

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.types import JsonObject
from springpot.host.emission.emission import read_emission
from springpot.host.native.c_library import COLUMN, LoopRows
from springpot.host.output import print_line, progress_console
from springpot.host.session.session import Session
from springpot.host.session.terminal import stopping_on_sigterm
from springpot.host.study.definition import RENDERED
from springpot.host.study.plan import Row, StudyPlan, Trial, append_only_table
from springpot.trainer.models.predict import SPEED_WINDOW_S

RESPONSES, ANSWERS = "responses.csv", "answers.csv"
RESPONSE_COLUMNS = (*Trial._fields, "rating", "seconds", "warnings", "log")
ANSWER_COLUMNS = ("participant", "question", "answer")
_KEYS = "l, r: feel left, right; 0 to 100: your rating; q: stop"
_CALM_S = 1.0  # between two warnings
_START_S = 0.01  # between two looks for the first tick


class PressWatch:
    """Takes the rows of a loop, of real objects too, and warns the participant.

    warnings: how many, of motion deeper or faster than given.
    """

    def __init__(self, dt_s: float, deepest_m: float, fastest_mps: float) -> None:
        self._deepest_m, self._step_m = deepest_m, fastest_mps * SPEED_WINDOW_S
        self._earlier_m = np.full(max(1, round(SPEED_WINDOW_S / dt_s)), np.nan)
        self._last_s = -np.inf
        self.warnings = 0

    def append(self, rows: LoopRows) -> None:
        """Take the next rows."""
        position_m, time_s = rows[:, COLUMN["position_m"]], rows[:, COLUMN["time_s"]]
        before, joined_m = len(self._earlier_m), np.concatenate((self._earlier_m, position_m))
        self._earlier_m = joined_m[-before:]
        fast = np.abs(joined_m[before:] - joined_m[:-before]) > self._step_m
        deep = position_m > self._deepest_m
        warned_s = time_s[deep | (fast & (position_m > 0.0))]
        if len(warned_s):
            if warned_s[0] > self._last_s + _CALM_S:
                self.warnings += 1
                print_line("less deep, please" if deep.any() else "slower, please")
                if progress_console.is_terminal:
                    progress_console.bell()
            self._last_s = float(warned_s[-1])


def run_session(plan: StudyPlan, participant: str, url: str) -> JsonObject:
    """Go on with the first session that is not over; return what `study run --json` prints.

    Standard input has what the participant types. Raises UsageError where nothing is left or the
    participant is unknown, DeviceError where the device fails: all that was rated stays.
    """
    if participant not in plan.participants:
        first, last = plan.participants[0], plan.participants[-1]
        raise UsageError(f"{plan.path}: no participant {participant!r}: it has {first} to {last}")
    folder, done, stopped = plan.folder(participant), 0, "stopped: the same command goes on"
    folder.mkdir(exist_ok=True)
    with (
        stopping_on_sigterm(),
        append_only_table(folder / RESPONSES, RESPONSE_COLUMNS) as (rated, respond),
        append_only_table(folder / ANSWERS, ANSWER_COLUMNS) as (answers, answer),
    ):
        left = planned_trials(plan, participant, rated)[len(rated) :]
        session = left[0].session if left else str(plan.study.sessions)
        ends = session == str(plan.study.sessions)
        questions = plan.study.questions[len(answers) :] if ends else []
        if not left and not questions:
            raise UsageError(f"{plan.path}: participant {participant} has finished all sessions")
        try:
            for trial in left:
                if trial.session == session:
                    respond([*trial, *_rated_trial(plan, trial, url)])
                    done += 1
            for question in questions:
                print_line(question)
                answer([participant, question, _typed()])
            stopped = "the session is over"
        except KeyboardInterrupt:
            pass
    return {"out": str(folder), "participant": participant, "session": int(session), "done": done,
            "stopped": stopped}  # fmt: skip


def planned_trials(plan: StudyPlan, participant: str, rated: Sequence[Row]) -> list[Trial]:
    """Return all trials of a participant. Raises DataError unless those rated are the first."""
    trials = [trial for trial in plan.trials if trial.participant == participant]
    for number, row in enumerate(rated):
        as_planned = Trial(*(row[name] for name in Trial._fields)) in trials[number : number + 1]
        if not as_planned or _rating(row["rating"]) is None:
            raise DataError(f"{plan.folder(participant) / RESPONSES}: row {number + 2} is not of "
                            "this plan: take the file from your backup")  # fmt: skip
    return trials


def _rated_trial(plan: StudyPlan, trial: Trial, url: str) -> tuple[object, ...]:
    """Render a trial until it is rated; return the further columns of its row."""
    scenes = {place: read_emission(place).plan for place in plan.scenes_of(trial)}
    place, scene = min(scenes.items(), key=lambda item: float(item[1].model.trained.max_m))
    trained, study = scene.model.trained, plan.study
    watch = PressWatch(
        scene.dt_s, study.warn_depth * trained.max_m, study.warn_speed * trained.max_mps
    )
    print_line(
        f"session {trial.session}, trial {trial.trial}: place the objects, lift the tool. {_KEYS}"
    )
    begin_s = time.perf_counter()
    folder = plan.folder(trial.participant)
    stem = f"session-{trial.session}-trial-{trial.trial:0>2}"
    # A trial that was begun before has left a log.
    names = (stem if attempt == 1 else f"{stem}-again-{attempt}" for attempt in count(1))
    log = next(folder / f"{name}.h5" for name in names if not any(folder.glob(f"{name}.*")))
    session = Session(
        place, url, log, viewers=[watch.append],
        report=lambda line: print_line(line) if line != session.line else None,
    )  # fmt: skip
    with session:
        session.start()
        session.pause()
        while not (session.state.ticks or session.over):  # nothing is felt before the first
            time.sleep(_START_S)
        rating = _ask(trial, session)
    if rating is None:
        raise session.error or KeyboardInterrupt
    seconds, log = f"{time.perf_counter() - begin_s:.1f}", session.result()["log"]
    return f"{rating:g}", seconds, watch.warnings, Path(log).name if log else ""


def _ask(trial: Trial, session: Session) -> float | None:
    """Let the participant feel both sides and rate; return the rating, None at an end."""
    sides, felt = {"l": trial.left, "r": trial.right}, set[str]()
    while True:
        word = _typed()
        state, rating = session.state, _rating(word)
        if session.over:
            return None
        if word == "reset":
            session.reset()
        elif word in sides and (state.latched or state.tripped):
            print_line("the force is off: type reset")
        elif word in sides:
            # The force is zero on a real object; on the rendered one it rises from zero.
            (session.resume if sides[word] == RENDERED else session.pause)()
            felt.add(word)
        elif rating is None or felt != set(sides):
            print_line(_KEYS if rating is None else "feel both sides before you rate: l and r")
        else:
            return rating


def _typed() -> str:
    """Return the next line of standard input. Raises KeyboardInterrupt for q and at its end."""
    line = sys.stdin.readline()
    if not line or line.strip() == "q":
        raise KeyboardInterrupt
    return line.strip()


def _rating(word: str) -> float | None:
    """Return the number from 0 to 100 that a word is, or None."""
    try:
        rating = float(word)
    except ValueError:
        return None
    return rating if 0.0 <= rating <= 100.0 else None
