"""The device of a study: one loop with the scenes of a trial, a log for each trial, a watch."""

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np

from springpot import DataError, Device, DeviceError, UsageError
from springpot.emission import read_emission
from springpot.host.wings.study.definition import Stimulus
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.session.presses import PressLimits, PressWatch
from springpot.host.wings.study.session.switched import PlacedNotes, SwitchedScenes
from springpot.loop import (
    COLUMN,
    LoopRows,
    LoopSettings,
    RowTaker,
    SessionLog,
    SessionRunner,
    requirements_of,
)
from springpot.native import Replay, SceneLibrary

_PACED_S = 0.2  # of ticks, to time a scene
_MARGIN = 1.5  # on the slowest scene's slow ticks
_MAX_SHARE = 0.5  # of a period: what every scene waits for the slowest


class TrialLogs:
    """Takes the rows of a session and keeps those of a trial."""

    def __init__(self, dt_s: float, source: str) -> None:
        self._dt_s, self._source = dt_s, source
        self._lock = threading.Lock()
        self._log: SessionLog | None = None
        self._watch: PressWatch | None = None
        self._begun = False

    def append(self, rows: LoopRows) -> None:
        """Take the next rows, from the loop's own drain thread."""
        with self._lock:
            rows = self._of_this_trial(rows)
            if self._watch is not None:
                self._watch.append(rows)
            if self._log is not None:
                self._log.append(rows)

    def _of_this_trial(self, rows: LoopRows) -> LoopRows:
        """Return rows of the trial before may still come: they end where nothing was felt."""
        if self._begun or self._watch is None:
            return rows
        free = np.flatnonzero(PlacedNotes.of(rows[:, COLUMN["notes"]]).place == 0)
        self._begun = len(free) > 0
        return rows[free[0] :] if self._begun else rows[:0]

    def begin(self, file: Path, details: Mapping[str, Any], watch: PressWatch) -> None:
        """Keep the rows from here on; nothing is felt at this moment."""
        log = SessionLog(file, self._dt_s, self._source, details)
        log.__enter__()
        with self._lock:
            self._log, self._watch, self._begun = log, watch, False

    def end(self, keep: bool) -> None:
        """Finish the trial's file, or leave none of a trial that does not count."""
        with self._lock:
            log, self._log, self._watch = self._log, None, None
        if log is None:
            return
        if keep and log.rows:
            with log:
                log.finish({})
        else:
            log.discard()
            log.__exit__(None, None, None)


class Apparatus:
    """A device with the scenes of a study, as a context manager. `switch`: of what is felt."""

    def __init__(
        self,
        folder: StudyFolder,
        url: str,
        viewer: RowTaker,
        report: Callable[[str], None],
    ) -> None:
        """Load and time all scenes. Raises DataError where one is not as planned."""
        self._folder, self.url = folder, url
        self._libraries = {name: _loaded(folder, name) for name in folder.scenes}
        scenes = list(folder.scenes.values())
        self.dt_s = folder.dt_s
        self.latency_s = latency_s(list(self._libraries.values()), self.dt_s)
        self.switch = SwitchedScenes(folder.real, self.latency_s)
        self._logs = TrialLogs(self.dt_s, url)
        max_n = max(scene.max_force_n for scene in scenes)
        device = Device(**scenes[0].device)
        self._requirements = requirements_of(
            device,
            rate_hz=scenes[0].rate_hz,
            watchdog_s=max(scene.watchdog_s for scene in scenes),
            max_n=max_n,
        )
        self._settings = LoopSettings(
            period_s=self.dt_s, max_force_n=max_n, reversed=device.force_sign == -1
        )
        self._viewer, self._report = viewer, report
        self._runner: SessionRunner | None = None

    def __enter__(self) -> Self:
        self._runner = SessionRunner(
            self.switch.steps(), self.url, self._requirements, self._settings,
            log=self._logs, viewer=self._viewer, report=self._report,
        )  # fmt: skip
        self._runner.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self.runner.close()
        self._logs.end(keep=False)

    @property
    def runner(self) -> SessionRunner:
        assert self._runner is not None, "use the apparatus in a with statement"
        return self._runner

    def require_running(self) -> None:
        """Raise why the loop has ended, where it has."""
        if self.runner.over:
            line, error = self.runner.why()
            raise error or DeviceError(line)

    def place(self, stimuli: Sequence[Stimulus]) -> None:
        """Put the scenes of a trial into their places; nothing may be felt meanwhile."""
        self.switch.place([self._libraries.get(stimulus.name) for stimulus in stimuli])

    def want(self, slot: int) -> None:
        """Feel what is in this slot, from 0, as soon as the tool is above the surface."""
        self.switch.want(slot + 1)

    @property
    def active(self) -> int | None:
        """The slot that is felt."""
        place = self.switch.active
        return place - 1 if place else None

    def begin_log(self, file: Path, details: Mapping[str, Any], limits: PressLimits) -> PressWatch:
        """Keep the rows from here on, and watch them."""
        watch = PressWatch(self.dt_s, limits)
        self._logs.begin(file, details, watch)
        return watch

    def end_log(self, keep: bool) -> None:
        """End the trial's log."""
        if keep:
            time.sleep(0.05)  # the last rows are on their way
        self._logs.end(keep)


def latency_s(libraries: Sequence[SceneLibrary], dt_s: float) -> float:
    """Return how long every step is to last, so that no scene's own time can be the cue.

    Raises UsageError where that is too much of a period.
    """
    positions = np.linspace(-1e-3, 5e-3, 400)
    slow_s = 0.0
    for library in libraries:
        replay = Replay(library)
        position_m = positions.astype(library.dtype)
        times = replay.tick_times(position_m, np.zeros_like(position_m), dt_s, _PACED_S)
        slow_s = max(slow_s, 1e-9 * times.p99)
    found = 1e-5 * math.ceil(1e5 * _MARGIN * slow_s)
    if found > _MAX_SHARE * dt_s:
        raise UsageError(
            f"the slowest scene takes {1e6 * slow_s:.0f} us of a period of {1e6 * dt_s:.0f} us, "
            "and every scene waits for it: take a smaller model, or a lower rate"
        )
    return found


def _loaded(folder: StudyFolder, name: str) -> SceneLibrary:
    place = folder.path / folder.scenes[name].folder
    if read_emission(place).hash != folder.scenes[name].hash:
        raise DataError(f"{place}: another scene than was planned: plan the study anew")
    return SceneLibrary(place)
