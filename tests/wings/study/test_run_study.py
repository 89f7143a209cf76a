"""`springpot study run` on a simulated device: whole sessions, killed ones, a device that fails."""

import re
import signal
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from support.pages.run_pages import MAIN
from support.small_study import SOFT, planned, scene_stimulus, study_text
from support.study.same_forces import require_same_forces
from support.study_participant import ScriptedParticipant

from springpot.host.native.scene_library import SceneLibrary
from springpot.host.wings.study.folder import StudyFolder
from springpot.host.wings.study.responses import read_responses
from springpot.host.wings.study.session.conduct import JOURNAL
from springpot.host.wings.study.session.journal import read_lines
from springpot.host.wings.study.session.switched import PlacedNotes
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import read_recording, write_recording

pytestmark = pytest.mark.realtime
DEVICE = "sim://dragon-skin-10?hand=mid"
_PATIENCE_S = 120.0


class RunningStudy:
    """`springpot study run` as a process, with someone at its screen."""

    def __init__(self, folder: StudyFolder, device: str = DEVICE) -> None:
        command = [*MAIN, "study", "run", str(folder.path), "--participant", "01",
                   "--device", device]  # fmt: skip
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True,
        )  # fmt: skip
        # A latch waits for the experimenter's key, and nobody is there.
        self._limit = threading.Timer(_PATIENCE_S, self.process.kill)
        self._limit.start()
        self.told: list[str] = []
        self.participant: ScriptedParticipant | None = None

    def until(self, text: str) -> "RunningStudy":
        """Read what the experimenter is told, until it says that or ends."""
        for line in self.process.stderr:
            self.told.append(line)
            if found := re.search(r"http://\S+", line):
                self.participant = ScriptedParticipant(found[0])
            if text and text in line:
                return self
        return self

    def end(self) -> tuple[int, str]:
        """Exit status, and all that was printed."""
        with self.process:
            self.until("")
            printed = self.process.stdout.read()
        self._limit.cancel()
        if self.participant is not None:
            self.participant.join()
        return self.process.returncode, printed + "".join(self.told)


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    stimuli = [scene_stimulus("Quince"), scene_stimulus("Medlar", stiffer=1.5)]
    pairs = [{"left": "Quince", "right": "Medlar", "repeats": 2}]
    return planned(tmp_path, study_text("similarity", stimuli, pairs), 1, SOFT)


def require_finished(folder: StudyFolder) -> None:
    """Both trials count, and every force felt is that of the emitted C."""
    libraries = {
        name: SceneLibrary(folder.path / scene.folder) for name, scene in folder.scenes.items()
    }
    responses = read_responses(folder)[0]
    assert [one.number for one in responses] == [1, 2]
    for one in responses:
        assert one.presses >= 2
        assert one.deepest_m > 1e-3
        recording = read_recording(one.log)
        scenes = [libraries[name] for name in one.shown]
        assert require_same_forces(one.log.name, recording.channels, scenes) > 500
        place = PlacedNotes.of(recording.channels["notes"]).place
        changes = [k for k in range(1, len(place)) if place[k] != place[k - 1]]
        assert changes
        for k in changes:
            assert recording.position_m[k] <= 0, "changed below the surface"
            assert abs(recording.force_n[k - 1]) <= 1e-3, "changed while a force was felt"


def test_killed_in_the_second_trial_and_gone_on(folder: StudyFolder) -> None:
    running = RunningStudy(folder).until("Trial 2")
    running.process.send_signal(signal.SIGKILL)
    running.end()
    status, printed = RunningStudy(folder).until("Trial 2 of 2, attempt 2").end()
    assert status == 0, printed
    assert "the session is over" in printed
    for name in ("Quince", "Medlar", SOFT):
        assert name not in printed
    require_finished(folder)
    first = read_lines(folder.session_folder("01", 1) / JOURNAL)[0]
    assert first["rate_hz"] == 1000.0
    assert first["latency_us"] >= 10
    assert RunningStudy(folder).end()[0] == 2  # nothing is left


def test_a_device_that_ends_in_a_trial(folder: StudyFolder, tmp_path: Path) -> None:
    """Exit status 5 with the reason; what was open comes again."""
    recorded = tmp_path / "short.h5"
    above_m = np.full(900, -1e-3)
    short = Recording("short", above_m, 0 * above_m, 1e-3)
    write_recording(recorded, short, overwrite=False)
    status, printed = RunningStudy(folder, f"replay://{recorded}").end()
    assert status == 5, printed
    assert "no more samples" in printed
    assert RunningStudy(folder).end()[0] == 0
    require_finished(folder)
