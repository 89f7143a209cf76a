"""What goes wrong with a Force Dimension device while a hand presses: zero force, and why."""

import numpy as np
import pytest
from support.peer import Peer, peer
from support.sessions import ended, faithful

from springpot.codegen.notes import LATCHED
from springpot.host.native.c_library import NONE, UNSENT

pytestmark = pytest.mark.realtime


def felt(folder, tmp_path, device: Peer, seconds: float = 1.6, settings: str = ""):
    """A session in a hand: its result, what it said, its log; every force of it repeats."""
    said: list[str] = []
    session = ended(folder, device.url + settings, tmp_path / "a.h5", seconds=seconds,
                    reconnect_s=2.0, report=said.append)  # fmt: skip
    return session.result(), "\n".join(said), faithful(folder, tmp_path / "a.h5")


def require_fall_from(read, first: int) -> None:
    """Never more again, and zero after the watchdog's 20 ms and the fall's 10 ms at the latest."""
    assert read.force_n[:first].max() > 0.1, "the hand was not pressing"
    after_n = read.force_n[first:]
    assert np.all(np.diff(after_n) <= 0.0) and np.all(after_n[31:] == 0.0)


def first_not_at_work(read) -> int:
    call, notes = (read.channels[name].astype(int) for name in ("call", "notes"))
    (found,) = np.nonzero((call & NONE) | (notes & LATCHED))
    return int(found[0])


def test_forces_that_go_off_in_the_device(folder, tmp_path):
    """Its own safety: zero at once, in the SDK's words, until the user resets."""
    with peer("dhd_device", "--trip-after", 0.6) as device:
        result, said, read = felt(folder, tmp_path, device)
        fault = device.wait_for("fault")
    assert fault["was_n"] > 0.05 and "it switched its forces off for it moved too fast" in said
    assert result["latched"] and result["watchdog_trips"] == 1
    before_n, after_n = np.split(read.force_n, [first_not_at_work(read)])
    assert before_n.max() > 0.1 and np.all(after_n == 0.0)


def test_forces_that_are_not_taken(folder, tmp_path):
    """The last force would stay: forces are switched off instead, after two."""
    with peer("dhd_device", "--refuse-after", 0.6) as device:
        result, said, _ = felt(folder, tmp_path, device)
        stop = device.named("stop")[-1]
    assert stop["force_n"] == 0
    assert "the device switched its motor off (communication error)" in said
    assert result["latched"] and result["unsent"] >= 2


def test_calls_that_fail_for_a_moment(folder, tmp_path):
    """Nothing of it can be reached: gone, its own watchdog ends the force; then it ramps in."""
    with peer("dhd_device", "--fail-after", 0.6, "--fail-for", 0.05) as device:
        result, said, read = felt(folder, tmp_path, device, 1.4)
        assert device.named("tripped")[0]["was_n"] > 0.05
    assert "gone (communication error), force zero" in said and "force ramps in" in said
    assert result["disconnects"] == result["resets"] == 1
    (zero,) = np.nonzero(read.channels["notes"].astype(int) & LATCHED)
    again = read.force_n[zero[-1] + 1 :]
    assert again[0] == 0.0 and again.max() > 0.5 and np.max(np.abs(np.diff(again))) < 1.0


def test_a_call_that_hangs(folder, tmp_path):
    """The device's own watchdog ends the force meanwhile; then the host says which call it was."""
    with peer("dhd_device", "--burst-after", 0.6, "--burst-for", 0.3) as device:
        result, said, read = felt(folder, tmp_path, device)
        tripped = device.wait_for("tripped")
    assert tripped["was_n"] > 0.05 and tripped["silent_ms"] < 30
    assert "a call of its SDK took more than 20 ms" in said and result["latched"]
    # Ticks that come before the call hangs for good are held, as the law has it.
    require_fall_from(read, first_not_at_work(read))


def test_its_button_stops(folder, tmp_path):
    with peer("dhd_device", "--button-after", 0.6) as device:
        result, said, _ = felt(folder, tmp_path, device, 20.0)
        zero = device.wait_for("zero")
    assert "stopped by the device's button" in said and zero["was_n"] > 0.05
    assert result["ticks"] < 5000 and not result["latched"]


def test_motors_that_give_less_are_counted(folder, tmp_path):
    with peer("dhd_device", "--saturated-n", 0.2) as device:
        result, _, read = felt(folder, tmp_path, device)
    sent = (read.channels["call"].astype(int) & UNSENT) == 0
    assert result["saturated"] == np.count_nonzero(sent & (read.force_n > 0.2)) > 0


def test_walls_hold_the_tool_on_its_line(folder, tmp_path):
    """A push across of 2 N: 1 kN/m give 2 mm; without walls the tool goes where it is pushed."""
    place_m = []
    for settings in ("", "&walls_npm=1000"):
        with peer("dhd_device", "--sideways-n", 2.0) as device:
            log = tmp_path / (settings or "free")
            log.mkdir()
            felt(folder, log, device, 1.0, settings)
            place_m.append(abs(device.named("stop")[-1]["place_m"][0]))
    assert place_m[0] > 0.02 and place_m[1] < 0.0025
