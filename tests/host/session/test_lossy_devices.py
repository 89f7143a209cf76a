"""A hand that presses through devices that lose 1 % of their samples and send 2 % a period late."""

import numpy as np
import pytest
from support.peer import peer, wait_until
from support.small import model_file, scene

from springpot.codegen.reference.notes import LATCHED, RAMPED
from springpot.host.emission.emission import emit
from springpot.host.native.loop_library import IDLE, NONE
from springpot.host.session.session import Session
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.recording_file import read_recording

LOSSES = ("--drop", 0.01, "--late", 0.02, "--presses-hz", 2)


@pytest.mark.realtime
@pytest.mark.parametrize("mode", ["off", "proxy"])
@pytest.mark.parametrize(
    "device",
    [("serial_device",), ("slcan_odrive",), ("udp_odrive", "--port", 43225)],
    ids=lambda device: device[0],
)
def test_losses_are_not_felt(tmp_path, device, mode):
    folder, log = tmp_path / "c", tmp_path / "a.h5"
    emit(scene(mode=mode), model_file(tmp_path), folder, accept_unsafe=True)
    with (
        peer(*device, *LOSSES) as lossy,
        Session(folder, lossy.url, log, seconds=4.0, report=list) as session,
    ):
        session.start()
        wait_until(lambda: session.runner.over, 20, "does not end")
    assert session.line == "ran for 4 s"
    result, read = session.result(), read_recording(log)
    assert validate(folder, [read], paced_s=0.01).mismatches == 0
    assert result["watchdog_trips"] == 0
    call, notes = (read.channels[name].astype(int) for name in ("call", "notes"))
    assert not np.any(notes & LATCHED)
    assert len(call) == result["ticks"] == pytest.approx(4000, abs=2)
    idle = np.count_nonzero(call & IDLE)
    assert idle >= 10
    # Each sample that came was stepped once, apart from those of periods that were settled without
    # one while the machine held the peer up.
    if device[0] != "udp_odrive":  # threads of Python carry its frames
        assert result["unused_samples"] <= 40
        assert idle <= 80
    if device[0] == "serial_device":  # it numbers its frames: only what was lost is missing
        assert abs(idle - result["sequence_gaps"]) <= 4 + result["unused_samples"]
    inside = (read.position_m > 1e-3) & ((call & NONE) == 0) & ((notes & RAMPED) == 0)
    assert np.count_nonzero(inside) > 1000
    zero = np.count_nonzero(inside & ((read.channels["returned_n"] <= 0) | (read.force_n <= 0)))
    # The proxy is not told yet how much time a lost sample was: a few of its ticks are zero.
    assert zero <= {"off": 0, "proxy": 20}[mode]
