"""A whole study with simulated people: the same plan, journals and logs, the same emitted C."""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from springpot import DataError, UsageError
from springpot.basics import Samples, write_file
from springpot.host.wings.study.definition import Question, Stimulus
from springpot.host.wings.study.folder import OBSERVERS, StudyFolder, copy_study
from springpot.host.wings.study.observers.observer import FeltPress, Observer, answer
from springpot.host.wings.study.session.conduct import (
    PresentedTrial,
    Record,
    TrialOutcome,
    conduct,
    next_session,
)
from springpot.host.wings.study.session.presses import PressWatch
from springpot.host.wings.study.session.switched import SwitchedScenes
from springpot.loop import COLUMN, LoopRows, SessionLog, empty_rows
from springpot.native import SceneLibrary
from springpot.simulation import (
    HandLoop,
    LoopCalls,
    ObjectMotion,
    Operator,
    Scenario,
    SimulatedHand,
    parse_url,
)

_START_M = -1e-3
_PRESS_S, _LIFT_S = 0.8, 0.3  # in and out; then away
_INTENDED_M = (0.010, 0.018)  # where the hand intends to go: its spring decides how deep it comes


@dataclass(frozen=True, eq=False)
class SimulatedStudy:
    """What was simulated: the folder that it is in, and trials done."""

    folder: StudyFolder
    trials: int


def simulate(
    of: StudyFolder, observers: int, seed: int, out: Path, progress: Callable[[int, int], None]
) -> SimulatedStudy:
    """Run the study with so many simulated people, into a new folder.

    Trajectories are kept of the first of them. progress: takes people done, of how many. Raises
    UsageError where a real object has nothing that stands for it.
    """
    for stimulus in of.study.stimulus:
        if stimulus.real is not None and stimulus.simulated is None:
            raise UsageError(
                f"stimulus {stimulus.name!r}: a real object, which nobody can press here: name the "
                'simulated one that stands for it, such as simulated = "sim://ecoflex-00-30"'
            )
    folder = copy_study(of, observers, out)
    scenes = {
        name: SceneLibrary(folder.path / scene.folder) for name, scene in folder.scenes.items()
    }
    people = []
    for k, participant in enumerate(folder.participants):
        random = np.random.default_rng([seed, k])
        people.append((participant, Observer.drawn(random), random))
    known = {participant: observer.as_dict() for participant, observer, _ in people}
    write_file(folder.path / OBSERVERS, (json.dumps(known, indent=1) + "\n").encode())
    counts: dict[str, int] = {}
    for done, (participant, observer, random) in enumerate(people):
        progress(done, observers)
        person = SimulatedPerson(folder, scenes, observer, random, keeps_logs=done == 0)
        while (session := next_session(folder, participant)) is not None:
            conduct(folder, participant, session, person, counts)
    return SimulatedStudy(folder, counts.get("done", 0))


class SimulatedPerson:
    """Presses what is in every slot once, and answers: a `Presenter`."""

    def __init__(
        self,
        folder: StudyFolder,
        scenes: Mapping[str, SceneLibrary],
        observer: Observer,
        random: np.random.Generator,
        keeps_logs: bool,
    ) -> None:
        self._folder, self._scenes, self._observer = folder, scenes, observer
        self._random, self._keeps_logs = random, keeps_logs
        self._switch = SwitchedScenes(folder.real)
        steps = self._switch.steps()
        calls = LoopCalls(steps.step, steps.idle, steps.reset, steps.state, kept=steps)
        self._hand = HandLoop(calls, folder.real)

    def metadata(self) -> dict[str, Any]:
        """Return what stands for the device."""
        return {"device": "simulated hand", "rate_hz": round(1 / self._folder.dt_s, 3)}

    def trial(self, trial: PresentedTrial, record: Record) -> TrialOutcome:
        """Press every slot and answer."""
        self._switch.place([self._scenes.get(one.name) for one in trial.stimuli])
        intended_m = self._intended_m(float(self._random.uniform(*_INTENDED_M)))
        watch = PressWatch(self._folder.dt_s)
        presses, all_rows = [], []
        for slot, stimulus in enumerate(trial.stimuli):
            press, rows = self._press(stimulus, slot + 1, intended_m)
            watch.append(rows)
            presses.append(press)
            all_rows.append(rows)
        counts = watch.counts[1:]
        record("pressed", presses=[count.presses for count in counts[: len(presses)]])
        given = answer(self._observer, self._folder.study, presses, self._random)
        record("answered", answer=given)
        details = watch.summary()
        if self._keeps_logs:
            self._write_log(trial, np.concatenate(all_rows))
            details["log"] = trial.log.name
        return TrialOutcome(given, details)

    def question(self, _number: int, _of: int, question: Question) -> str:
        """Return a choice at random; a simulated person has no words."""
        choices = question.choices
        return choices[int(self._random.integers(len(choices)))] if choices else "(simulated)"

    def finished(self, session: int) -> None:
        """Do nothing: there is nobody to thank."""

    def _intended_m(self, reach_m: float) -> Samples:
        """Plan a press in and out once, (n,), from above the surface."""
        dt_s = self._folder.dt_s
        turn = np.linspace(0, 2 * math.pi, round(_PRESS_S / dt_s))
        press_m = _START_M + (reach_m - _START_M) * 0.5 * (1 - np.cos(turn))
        return np.concatenate((press_m, np.full(round(_LIFT_S / dt_s), 2 * _START_M)))

    def _press(
        self, stimulus: Stimulus, place: int, intended_m: Samples
    ) -> tuple[FeltPress, LoopRows]:
        """Press what is in a place: as it was felt, and the rows of it."""
        seed = int(self._random.integers(2**31))
        self._switch.want(place)
        rows = empty_rows(len(intended_m))
        if stimulus.real is not None:
            press = self._press_real(stimulus, intended_m)
            rows[:, COLUMN["position_m"]] = press.position_m
            rows[:, COLUMN["notes"]] = place << 8
            self._switch.want(0)
        else:
            press = self._press_scene(intended_m, seed, rows)
        rows[:, COLUMN["time_s"]] = self._folder.dt_s * np.arange(len(rows))
        rows[:, COLUMN["dt_s"]] = self._folder.dt_s
        rows[:, COLUMN["measured_n"]] = np.nan
        return press, rows

    def _press_scene(self, intended_m: Samples, seed: int, rows: LoopRows) -> FeltPress:
        operator = Operator("mid", seed=seed)
        trace = self._hand.run(self._scenario(intended_m), operator, _START_M)
        rows[:, COLUMN["position_m"]] = trace.seen_m
        rows[:, COLUMN["velocity_mps"]] = trace.seen_mps
        rows[:, COLUMN["returned_n"]] = rows[:, COLUMN["sent_n"]] = trace.force_n
        rows[:, COLUMN["notes"]] = trace.notes
        if trace.notes.min() < 0 or (trace.notes[0] >> 8) & 3 == 0:
            raise DataError("the hand met no scene: the last press had not left the surface")
        self._switch.want(0)
        away_m = np.full(1, 2 * _START_M)  # one tick above the surface: the place is left
        self._hand.run(self._scenario(away_m), operator, float(away_m[0]))
        return FeltPress(trace.position_m, trace.force_n)

    def _scenario(self, intended_m: Samples) -> Scenario:
        """Let the hand intend to be there, (n,), with no disturbance."""
        n = len(intended_m)
        return Scenario(np.full(n, self._folder.dt_s), intended_m, np.full(n, np.nan), np.zeros(n),
                        np.zeros(n, dtype=np.uint8))  # fmt: skip

    def _press_real(self, stimulus: Stimulus, intended_m: Samples) -> FeltPress:
        """Return the same hand on the simulated object that stands for a real one."""
        assert stimulus.simulated is not None
        hand = SimulatedHand("mid", substeps=16, position_m=_START_M)
        pressed = ObjectMotion(parse_url(stimulus.simulated), self._folder.dt_s)
        position_m, force_n = hand.press(pressed, intended_m)
        return FeltPress(position_m, force_n)

    def _write_log(self, trial: PresentedTrial, rows: LoopRows) -> None:
        of = {"trial": trial.number, "attempt": trial.attempt, "codes": list(trial.codes)}
        dt_s = self._folder.dt_s
        rows[:, COLUMN["time_s"]] = dt_s * np.arange(len(rows))
        with SessionLog(trial.log, dt_s, "simulated hand", {"study": of}) as log:
            log.append(rows)
            log.finish({})
