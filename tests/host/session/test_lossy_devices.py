"""A hand that presses through devices that lose 1 % of their samples and send 2 % a period late."""

from dataclasses import replace

import numpy as np
import pytest
from support.peer import peer
from support.sessions import ended, faithful
from support.small import model_file, scene

from springpot.codegen.notes import LATCHED, RAMPED
from springpot.codegen.scene import Guard
from springpot.host.emission.emission import emit
from springpot.host.native.c_library import IDLE, NONE
from springpot.host.native.scene_library import SceneLibrary

WATCHDOG_MS = 200  # longer than a busy machine holds everything up
LOSSES = ("--drop", 0.01, "--late", 0.02, "--presses-hz", 2)


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("device", "mode"),
    [("serial_device", "proxy"), ("slcan_odrive", "off")],
)
def test_losses_are_not_felt(tmp_path, device, mode):
    folder, log = tmp_path / "c", tmp_path / "a.h5"
    waits = replace(scene(mode=mode), guard=Guard(watchdog_ms=WATCHDOG_MS))
    emit(waits, model_file(tmp_path), folder, accept_unsafe=True)
    with peer(device, *LOSSES) as lossy:
        session = ended(folder, lossy.url, log, seconds=4.0)
    assert session.line == "ran for 4 s"
    result, read = session.result(), faithful(folder, log)
    assert result["watchdog_trips"] == 0
    call, notes = (read.channels[name].astype(int) for name in ("call", "notes"))
    assert not np.any(notes & LATCHED)
    assert len(call) == result["ticks"] == pytest.approx(4000, abs=2)
    idle = np.count_nonzero(call & IDLE)
    assert idle >= 10
    # Each sample that came was stepped once, apart from those of periods settled without one
    # while the machine held the peer up.
    if result["lateness_us"]["max"] <= 3000:
        assert result["unused_samples"] <= 40
        assert idle <= 80
        if device == "serial_device":  # it numbers its frames: only what was lost is missing
            assert abs(idle - result["sequence_gaps"]) <= 4 + result["unused_samples"]
    clean_n = loss_free_n(folder, read)
    known = ((call & (IDLE | NONE)) == 0) & ((notes & RAMPED) == 0) & (read.position_m > 0)
    known[1:] &= known[:-1]
    pressed = known & (clean_n > 0.05 * clean_n.max())
    assert np.count_nonzero(pressed) > 1000
    returned_n = read.channels["returned_n"]
    assert not np.any(pressed & ((returned_n <= 0) | (read.force_n <= 0)))
    steps_n, clean_steps_n = (np.abs(np.diff(n, prepend=n[0])) for n in (returned_n, clean_n))
    assert steps_n[known].max() <= 1.5 * clean_steps_n[known].max() + 0.1


def loss_free_n(folder, read):
    """The scene's force, N, had every sample come: what was lost lies between its neighbours."""
    come = (read.channels["call"].astype(int) & (IDLE | NONE)) == 0
    ticks = np.arange(len(come))
    position_m = np.interp(ticks, ticks[come], read.position_m[come])
    force_n, _ = SceneLibrary(folder).new_state().run(position_m)
    return force_n.astype(float)
