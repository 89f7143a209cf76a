"""Where a session stands, read from its journal: what is done, what comes next."""

from collections.abc import Sequence
from dataclasses import dataclass

from springpot import DataError
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.methods.levels import next_pair, open_series
from springpot.host.wings.study.schedule import PlannedTrial, adaptive_trial, fixed_trials
from springpot.host.wings.study.session.journal import Line

INTERRUPTED = "interrupted"  # the reason of a trial that comes again at once


@dataclass(frozen=True)
class TrialToShow:
    """A trial with its pair; shown: names in the slots, left to right; attempt: from 1."""

    number: int
    attempt: int
    pair: int
    shown: tuple[str, ...]
    swapped: bool


@dataclass(frozen=True)
class DoneTrial:
    """A trial that counts: its plan, and its lines."""

    trial: TrialToShow
    answered: Line
    lines: tuple[Line, ...]


class SessionProgress:
    """One session: a function of the plan and of the journal's lines."""

    def __init__(self, folder: StudyFolder, participant: str, session: int) -> None:
        self._study, self._session = folder.study, session
        self._participant = folder.number(participant)
        self._key, self._name = folder.key, participant
        self._fixed = (
            []
            if folder.study.adaptive and session
            else fixed_trials(folder.study, self._participant, session)
        )

    def next_trial(self, lines: Sequence[Line]) -> TrialToShow | None:
        """Return the trial to show, after these lines; None: the session has no more."""
        done = self.done(lines)
        attempts = _attempts(lines)
        planned = self._next_planned(lines, done)
        if planned is None:
            return None
        pair = planned.pair
        if pair is None:
            pair = next_pair(self._study, planned.series, self._history(done))
        swapped = planned.swapped and self._study.pair[pair].sides == "balanced"
        return TrialToShow(
            number=planned.number,
            attempt=attempts.get(planned.number, 0) + 1,
            pair=pair,
            shown=shown_stimuli(self._study, pair, swapped, planned.second),
            swapped=swapped,
        )

    def done(self, lines: Sequence[Line]) -> list[DoneTrial]:
        """Return trials that count, in the order in which they were done."""
        found: list[DoneTrial] = []
        trial: list[Line] = []
        for line in lines:
            if line["step"] == "shown":
                trial = [line]
            elif trial and line.get("trial") == trial[0]["trial"]:
                trial.append(line)
            if line["step"] == "done":
                answered = next((one for one in trial if one["step"] == "answered"), None)
                if answered is None:
                    raise DataError(f"trial {line['trial']}: done, and never answered: damaged")
                found.append(DoneTrial(self._shown(trial[0]), answered, tuple(trial)))
        return found

    def trials_in_all(self) -> int | None:
        """Return the number of a session's trials; None if answers decide it."""
        return len(self._fixed) or None

    def _shown(self, line: Line) -> TrialToShow:
        """Return what a line says was shown: its codes opened, which must be what was planned."""
        shown = tuple(self._key.stimulus(self._name, code) for code in line["codes"])
        number = int(line["trial"])
        planned = self._fixed[number - 1] if 0 < number <= len(self._fixed) else None
        if planned is not None and planned.pair is not None:
            pair, swapped = planned.pair, planned.swapped
            expected = shown_stimuli(self._study, pair, swapped, planned.second)
        else:
            pair = next((k for k, one in enumerate(self._study.pair)
                         if sorted((one.left, one.right)) == sorted(shown)), 0)  # fmt: skip
            swapped = shown[0] == self._study.pair[pair].right
            expected = shown_stimuli(self._study, pair, swapped, second=False)
        if shown != expected:
            raise DataError(f"trial {number}: its codes are not those of the plan: another key")
        return TrialToShow(number, int(line["attempt"]), pair, shown, swapped)

    def _next_planned(
        self, lines: Sequence[Line], done: Sequence[DoneTrial]
    ) -> PlannedTrial | None:
        if self._fixed:
            by_number = {planned.number: planned for planned in self._fixed}
            order = queue([planned.number for planned in self._fixed], lines)
            return by_number[order[0]] if order else None
        if self._study.adaptive and self._session:
            history = self._history(done)
            left = open_series(self._study, history)
            if left:
                shown = [self._study.pair[pair].series for pair, _ in history]
                return adaptive_trial(self._study, self._participant, self._session, left, shown)
        return None

    def _history(self, done: Sequence[DoneTrial]) -> list[tuple[int, bool]]:
        """Return the pair of each trial, and whether the answer was correct."""
        return [(one.trial.pair, bool(is_correct(self._study, one.trial, one.answered["answer"])))
                for one in done]  # fmt: skip


def queue(numbers: Sequence[int], lines: Sequence[Line]) -> list[int]:
    """List the trials left: a voided one comes at the end, an interrupted one at once."""
    left = list(numbers)
    for line in lines:
        if line["step"] == "done":
            left.remove(line["trial"])
        elif line["step"] == "void" and line["reason"] != INTERRUPTED:
            left.remove(line["trial"])
            left.append(line["trial"])
    return left


def shown_stimuli(study: Study, pair: int, swapped: bool, second: bool) -> tuple[str, ...]:
    """Return names in the slots of a trial."""
    names = (study.pair[pair].left, study.pair[pair].right)
    first, other = names[::-1] if swapped else names
    if study.method == "abx":
        return first, other, other if second else first
    if study.method == "same-different":
        return first, first if second else other
    return first, other


def is_correct(study: Study, trial: TrialToShow, answer: float | str) -> bool | None:
    """Return whether an answer is right, the greater of two levels; None for a similarity."""
    if study.method == "similarity":
        return None
    if study.method == "abx":
        return answer == ("A" if trial.shown[2] == trial.shown[0] else "B")
    if study.method == "same-different":
        return answer == ("same" if trial.shown[0] == trial.shown[1] else "different")
    chosen = trial.shown[0 if answer == "left" else 1]
    levels = [study.stimulus_of(name).at_level for name in trial.shown]
    return study.stimulus_of(chosen).at_level == max(levels)


def _attempts(lines: Sequence[Line]) -> dict[int, int]:
    found: dict[int, int] = {}
    for line in lines:
        if line["step"] == "shown":
            found[line["trial"]] = line["attempt"]
    return found
