"""Trials on a device: what the participant feels and sees, what the experimenter has to do."""

import time
from dataclasses import replace
from typing import Any

from springpot.host.wings.study.definition import Question, Stimulus
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.session.apparatus import Apparatus
from springpot.host.wings.study.session.conduct import PresentedTrial, Record, TrialOutcome
from springpot.host.wings.study.session.experimenter import Experimenter, TrialVoidedError
from springpot.host.wings.study.session.presses import PressLimits, PressWatch, RunningTrial
from springpot.host.wings.study.session.screen import ParticipantScreen
from springpot.host.wings.study.session.screen_state import (
    FEEL_ALL,
    TOO_DEEP,
    TOO_FAST,
    Act,
    Ask,
    ScreenState,
    answers,
    slots,
    trial_question,
)

_LOOK_S = 0.03
_WARN_EVERY_S = 1.0
_CHOOSE = "Press each of them as often as you like, then answer."
_WAIT = "Please wait: the experimenter changes the object."
_LIFT = "Lift the tool off the surface."


class DevicePresenter:
    """Shows trials on a device; without one (`apparatus` None) all objects are real."""

    def __init__(
        self,
        folder: StudyFolder,
        apparatus: Apparatus | None,
        screen: ParticipantScreen,
        experimenter: Experimenter,
    ) -> None:
        self._folder, self._study, self._key = folder, folder.study, folder.key
        self._apparatus, self._screen, self._experimenter = apparatus, screen, experimenter
        self._there: str | None = None  # the real object under the tool

    def metadata(self) -> dict[str, Any]:
        """Describe the device, for the session's first line."""
        if self._apparatus is None:
            return {"device": None}
        return {
            "device": self._apparatus.url,
            "rate_hz": round(1 / self._apparatus.dt_s, 3),
            "latency_us": round(1e6 * self._apparatus.latency_s, 3),
            "scheduler": self._apparatus.runner.scheduler(),
        }

    def welcome(self, session: int) -> None:
        """Wait until the participant is ready."""
        title = "Practice" if session == 0 else f"Session {session} of {self._study.sessions}"
        self._screen.show(ScreenState(title, "Press Space when you are ready."))
        self._experimenter.report(f"{title}: waiting for the participant to press Space")
        self._until("next")

    def trial(self, trial: PresentedTrial, record: Record) -> TrialOutcome:
        """Show one trial until it is answered, or voided by the experimenter."""
        of = "" if trial.of is None else f" of {trial.of}"
        title = f"Trial {trial.number}{of}"
        again = "" if trial.attempt == 1 else f", attempt {trial.attempt}"
        self._experimenter.report(f"{title}{again}")
        late = 0 if self._apparatus is None else self._apparatus.runner.state.late
        overruns = 0 if self._apparatus is None else self._apparatus.switch.overruns
        run = None
        try:
            self._free(title)
            run = self._begin(trial, record, title)
            answer = self._run(run)
        except TrialVoidedError:
            self._experimenter.report(f"{title}: void; it comes again at the end")
            self._end(keep=False)
            return TrialOutcome(None, {} if run is None else run.details())
        except BaseException:
            self._end(keep=False)
            raise
        record("answered", answer=answer)
        self._end(keep=True)
        details = run.details()
        if self._apparatus is not None:
            details["late"] = self._apparatus.runner.state.late - late
            details["overruns"] = self._apparatus.switch.overruns - overruns
            details["log"] = trial.log.name
        return TrialOutcome(answer, details)

    def question(self, number: int, of: int, question: Question) -> str:
        """Ask one question at the end."""
        choices = tuple(question.choices)
        ask = Ask("choice" if choices else "text", question.text, choices=choices)
        self._screen.show(ScreenState(f"Question {number} of {of}", "", ask=ask))
        return str(self._until("answer").value)

    def finished(self, session: int) -> None:
        """Say that the session is over."""
        last = session == self._study.sessions
        thanks = "Thank you. You have finished." if last else "Thank you. This part is finished."
        self._screen.end(f"{thanks} Please tell the experimenter.")

    def _begin(self, trial: PresentedTrial, record: Record, title: str) -> RunningTrial:
        limits = self._limits(trial.stimuli)
        if self._apparatus is None:
            watch = PressWatch(1.0)
        else:
            self._apparatus.place(trial.stimuli)
            of = {"trial": trial.number, "attempt": trial.attempt, "codes": list(trial.codes)}
            watch = self._apparatus.begin_log(trial.log, {"study": of}, limits)
        state = ScreenState(
            title=title,
            instruction=_CHOOSE,
            slots=slots(self._study),
            ask=trial_question(self._study),
            guideline_m=limits.deepest_m,
        )
        self._screen.show(state)
        return RunningTrial(trial, record, watch, state)

    def _run(self, run: RunningTrial) -> float | str:
        while True:
            self._look_after(run)
            act = self._screen.next_act(_LOOK_S)
            if act is None:
                continue
            if act.kind == "slot":
                self._choose(run, int(act.value))
            elif act.kind == "answer" and run.pressed:
                return str(act.value) if answers(self._study) else float(act.value)
            elif act.kind == "answer":
                self._screen.warn(FEEL_ALL)
                self._show(run, run.state)

    def _choose(self, run: RunningTrial, slot: int) -> None:
        """Let the chosen slot be felt next; the experimenter changes real objects."""
        if slot in {run.state.active, run.state.wanted}:
            return
        real = run.shown.stimuli[slot].name if run.shown.stimuli[slot].real else None
        if real != self._there:
            self._change_object(run, real)
        self._show(run, replace(run.state, wanted=slot))
        if self._apparatus is not None:
            self._apparatus.want(slot)

    def _change_object(self, run: RunningTrial, name: str | None) -> None:
        self._free(run.state.title)
        self._show(run, replace(run.state, active=None, wanted=None, instruction=_WAIT))
        stickers = self._key.stickers
        away = "" if self._there is None else f"take {stickers[self._there]} away"
        put = "" if name is None else f"put {stickers[name]} under the tool"
        self._experimenter.report(f"  {', '.join(filter(None, (away, put)))}; then press Enter")
        while not self._experimenter.look():
            self._require_running()
            time.sleep(_LOOK_S)
        self._there = name
        run.state = replace(run.state, instruction=_CHOOSE)

    def _look_after(self, run: RunningTrial) -> None:
        """Look at the experimenter's keys, the device, warnings, and what became of a choice."""
        self._experimenter.look()
        self._require_running()
        active = run.state.wanted if self._apparatus is None else self._apparatus.active
        if active is not None and active == run.state.wanted:
            self._show(run, replace(run.state, active=active, wanted=None))
        if self._apparatus is None and active is not None:
            run.felt.add(active)  # nothing measures whether it was pressed
        counts = run.watch.counts
        run.felt |= {k - 1 for k, count in enumerate(counts) if k and count.presses}
        if not run.pressed and len(run.felt) == len(run.shown.stimuli):
            run.pressed = True
            run.record("pressed", presses=[c.presses for c in counts[1 : len(run.felt) + 1]])
        self._warn(run)

    def _warn(self, run: RunningTrial) -> None:
        watch, now_s = run.watch, time.monotonic()
        too_much = run.state.active is not None and (watch.too_deep or watch.too_fast)
        if not too_much or now_s - run.warned_s < _WARN_EVERY_S:
            return
        run.warned_s = now_s
        run.warnings += 1
        self._screen.warn(TOO_DEEP if watch.too_deep else TOO_FAST)

    def _show(self, run: RunningTrial, state: ScreenState) -> None:
        run.state = state
        self._screen.show(state)

    def _free(self, title: str) -> None:
        """Wait until nothing is felt any more: the tool is above the surface."""
        if self._apparatus is None:
            return
        self._apparatus.switch.want(0)
        shown = False
        while self._apparatus.switch.active:
            if not shown:
                self._screen.show(ScreenState(title, _LIFT))
                shown = True
            self._experimenter.look()
            self._require_running()
            time.sleep(_LOOK_S)

    def _end(self, keep: bool) -> None:
        if self._apparatus is not None:
            self._apparatus.end_log(keep)
            self._apparatus.switch.want(0)

    def _until(self, kind: str) -> Act:
        """Return the next act of this kind."""
        while True:
            try:
                self._experimenter.look()
            except TrialVoidedError:
                self._experimenter.report("no trial is under way: nothing to void")
            self._require_running()
            act = self._screen.next_act(_LOOK_S)
            if act is not None and act.kind == kind:
                return act

    def _require_running(self) -> None:
        if self._apparatus is not None:
            self._apparatus.require_running()

    def _limits(self, stimuli: tuple[Stimulus, ...]) -> PressLimits:
        """Take the strictest limits of a trial, so that warnings tell no stimulus from another."""
        limits = self._study.limits
        depths_m = [self._folder.max_depth_m(stimulus) for stimulus in stimuli]
        known_m = [depth_m for depth_m in depths_m if depth_m is not None]
        if limits.warn_depth_mm is not None:
            known_m = [1e-3 * limits.warn_depth_mm]
        scenes = self._folder.scenes
        speeds = [limits.warn_speed * scenes[one.name].max_mps
                  for one in stimuli if one.name in scenes]  # fmt: skip
        return PressLimits(min(known_m, default=None), min(speeds, default=None))
