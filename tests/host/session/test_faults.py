"""What goes wrong in a session, each by a real process: the force is zero, the log reads, a line
says why."""

import json
import os
import random
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from support.peer import CLI, Peer, peer, wait_until
from support.sessions import faithful

from springpot.codegen.notes import LATCHED
from springpot.host.native.c_library import NONE, RESET, SILENT
from springpot.trainer.recordings.recording_file import read_recording

HELD = ("serial_device", "dhd_device")  # by a hand that presses
ROUNDS = int(os.environ.get("SPRINGPOT_ROUNDS", "1"))


class Host:
    """`springpot run` as a process of its own."""

    def __init__(self, folder: Path, device: Peer, log: Path, *options: object, **more) -> None:
        command = [*CLI, "run", "--scene", folder, "--device", device.url, "--log", log, "--json",
                   *options]  # fmt: skip
        self.log = log
        self.process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True,
                                        stderr=subprocess.PIPE, **more)  # fmt: skip

    def end(self, seconds: float = 30.0) -> tuple[dict, str]:
        out, self.err = self.process.communicate(timeout=seconds)
        assert "Traceback" not in self.err, self.err
        return json.loads(out) if out else {}, self.err


def wait_for_force(device: Peer, log: Path) -> None:
    """Until the hand has pressed for a while, as the peer's clock shows and the log's rows do."""
    start, journal = device.wait_for("start")["at_s"], log.with_suffix(".journal")
    wait_until(lambda: journal.exists() and journal.stat().st_size > 3 * 4096, 10, "no log")
    time.sleep(max(0.0, start + 0.9 - time.monotonic()))


@pytest.mark.realtime
@pytest.mark.parametrize("kind", HELD)
@pytest.mark.parametrize("round_", range(ROUNDS))
def test_host_killed_in_a_press(tmp_path, folder, round_, kind):
    """SIGKILL: no force within 50 ms, by the device itself; the log reads to the last second."""
    with peer(kind) as device:
        host = Host(folder, device, tmp_path / "a.h5")
        wait_for_force(device, host.log)
        time.sleep(random.uniform(0, 0.1))
        host.process.send_signal(signal.SIGKILL)
        killed_s = time.monotonic()
        host.process.communicate()
        tripped = device.wait_for("tripped")
    assert tripped["was_n"] > 0 and tripped["at_s"] - killed_s < 0.050
    read, started_s = faithful(folder, host.log), device.named("start")[-1]["at_s"]
    assert read.duration_s > killed_s - started_s - 1.0 and "recovered" in read.details


@pytest.mark.realtime
def test_host_killed_over_slcan(tmp_path, folder):
    """The drive's own watchdog does the same."""
    with peer("slcan_odrive") as device:
        host = Host(folder, device, tmp_path / "a.h5")
        device.wait_for("state", more=1)
        time.sleep(1.0)
        host.process.send_signal(signal.SIGKILL)
        killed_s = time.monotonic()
        host.process.communicate()
        tripped = device.wait_for("tripped", more=1)
    assert tripped["was_nm"] and tripped["at_s"] - killed_s < 0.050
    faithful(folder, host.log)


@pytest.mark.realtime
@pytest.mark.parametrize("round_", range(ROUNDS))
def test_device_gone_and_back(tmp_path, folder, round_):
    """Unplugged in a press, back in time: zero between, one reset by the host, ramped in, all
    logged."""
    with peer("serial_device", "--gone-after", 0.8, "--gone-for", 0.4) as device:
        host = Host(folder, device, tmp_path / "a.h5", "--seconds", 2.6)
        result, err = host.end()
        back_s = device.named("back")[0]["at_s"]
        starts = [event["at_s"] for event in device.named("start")]
    assert result["watchdog_trips"] == 1
    assert host.process.returncode == 0, err
    assert re.search(r"gone( \(communication error\))?, force zero", err)
    assert "force ramps in" in err and result["disconnects"] == 1
    again = [start_s for start_s in starts if start_s > back_s]
    assert 0 < len(again) < len(starts)
    read = faithful(folder, host.log)
    assert abs(len(read.position_m) - 2600) <= 3
    call, notes = (read.channels[name].astype(int) for name in ("call", "notes"))
    (reset,) = np.flatnonzero(call & RESET)
    assert result["resets"] == 1
    lost = np.flatnonzero(notes & LATCHED)
    assert len(lost) > 200 and np.all(lost < reset)
    after = read.force_n[reset : reset + 100]
    assert after[0] == 0 and np.max(np.abs(np.diff(after))) < 1.0 and result["latched"] is False


def test_device_gone_for_good(tmp_path, folder):
    with peer("serial_device", "--gone-after", 0.5) as device:
        host = Host(folder, device, tmp_path / "a.h5", "--seconds", 20, "--reconnect-s", 0.7)
        result, err = host.end()
    assert host.process.returncode == 5
    assert "gone for 0.7 s, force zero, stopped" in err and "plug it in" in err
    assert result["ticks"] < 5000
    faithful(folder, host.log)
    assert "gone" in read_recording(host.log).details["end"]["stopped"]


@pytest.mark.realtime
@pytest.mark.parametrize("round_", range(ROUNDS))
def test_device_silent_and_back(tmp_path, folder, round_):
    """A trip that was no disconnect stays until the user resets, though samples come again."""
    with peer("serial_device", "--silent-after", 0.8, "--silent-for", 0.3) as device:
        host = Host(folder, device, tmp_path / "a.h5", "--seconds", 2.0)
        result, err = host.end()
    assert result["watchdog_trips"] == 1
    assert host.process.returncode == 0, err
    assert "the watchdog had tripped and the force was zero" in result["stopped"]
    assert "force zero until reset" in err and result["latched"] is True and result["resets"] == 0
    read = faithful(folder, host.log)
    notes = read.channels["notes"].astype(int)
    call = read.channels["call"].astype(int)
    latched = np.flatnonzero((notes & LATCHED) | (call & NONE))
    assert np.all(np.diff(latched) == 1) and latched[-1] == len(notes) - 1
    assert np.all(read.force_n[latched[0] + 20 :] == 0)


def test_disk_full_while_logging(tmp_path, folder):
    """The session ends with zero force and one line; what was written reads."""
    limit = 400 << 10

    def full() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    with peer("serial_device") as device:
        host = Host(folder, device, tmp_path / "a.h5", "--seconds", 20, preexec_fn=full)
        _, err = host.end()
        stop = device.wait_for("stop")
    assert host.process.returncode == 5, err
    assert "make room" in err and stop["force_n"] == 0
    read = faithful(folder, host.log)
    row_bytes = 8 * (2 + len(read.channels))
    assert len(read.position_m) > 0.3 * limit / row_bytes  # of pages that are half full


@pytest.mark.realtime
@pytest.mark.parametrize("held_s", [0.008, 0.12])
def test_a_burst_of_late_samples(tmp_path, folder, held_s):
    """Shorter than the watchdog's time: held, and on. Longer: zero, until the user resets."""
    log = tmp_path / "a.h5"
    with peer("serial_device", "--burst-after", 0.7, "--burst-for", held_s) as device:
        host = Host(folder, device, log, "--seconds", 1.6)
        result, err = host.end()
    assert host.process.returncode == 0, err
    read = faithful(folder, log)
    assert result["ring_dropped"] == result["sequence_gaps"] == 0
    assert result["latched"] is (held_s > 0.02)
    if held_s > 0.02:
        assert "force zero until reset" in err and read.force_n[-1] == 0


@pytest.mark.realtime
@pytest.mark.parametrize(("number", "kind"), [(signal.SIGINT, HELD[0]), (signal.SIGTERM, HELD[1])])
def test_asked_to_end_in_a_press(tmp_path, folder, number, kind):
    """By other signals: test_ending_signals.py."""
    with peer(kind) as device:
        host = Host(folder, device, tmp_path / "a.h5")
        wait_for_force(device, host.log)
        host.process.send_signal(number)
        out, err = host.end()
        stop = device.wait_for("stop")
    assert host.process.returncode == 0, (out, err)
    assert stop["force_n"] == 0
    assert device.named("zero"), "the hand was not pressing"
    # A host that is slow to leave after its last force, zero, may meet the device's own watchdog.
    assert not any(trip["was_n"] for trip in device.named("tripped")) and "until reset" not in err
    read = faithful(folder, host.log)
    assert not np.any(read.channels["call"].astype(int) & SILENT)
    assert "interrupted" in out["stopped"]
