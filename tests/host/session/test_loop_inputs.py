"""What the loop makes of its device's motion and load cell, frame by frame over a socket pair."""

import math
import socket
import struct
import time
from types import SimpleNamespace

import numpy as np
import pytest
from support.peer import wait_until

from springpot.host.devices.odrive import CLOSED_LOOP, ENCODER, HEARTBEAT, TORQUES
from springpot.host.native.loop_library import COLUMN, NONE, SILENT, Stop, empty_rows
from springpot.host.recording.indentation import press_step_functions
from springpot.host.session.c_loop import CLoop
from springpot.host.session.loop import LoopSettings
from springpot.host.session.outcome import why_stopped

PERIOD_S = 1e-3
GAINS = {"p_gain": 0.0, "d_gain_s": 0.0, "d_time_s": 1e-3}


class Drive:
    """The other end of an ODrive's link: it sends frames when the test says so.

    1 m per turn: a position of x turns is x m, a torque of t Nm is 2 pi t N.
    """

    comes_back = True

    def __init__(self):
        self.far, self.near = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.near.setblocking(False)
        self.send(HEARTBEAT, struct.pack("<IB3x", 0, CLOSED_LOOP))

    def link(self, library):
        settings = library.ffi.new("sp_odrive *", {
            "node": 0, "slcan": 0, "with_torque": 1, "m_per_turn": 1.0, "sign": 1.0,
            "zero_turns": 0.0, "surface_m": 0.0, "max_torque_nm": 100.0,
        })  # fmt: skip
        self.memory = library.memory(library.c.sp_link_odrive_size())
        return library.c.sp_link_odrive_init(self.memory, self.near.fileno(), settings)

    def send(self, command, data):
        self.far.send(struct.pack("=IB3x8s", command, 8, data))

    def sample(self, position_m, force_n):
        self.send(TORQUES, struct.pack("<ff", 0.0, force_n / (2 * math.pi)))
        self.send(ENCODER, struct.pack("<ff", position_m, 0.0))

    def close(self):
        self.near.close()
        self.far.close()


class Run(SimpleNamespace):
    """A loop of force control without force, its drive, and all rows until now."""

    def rows(self):
        self.taken = np.concatenate((self.taken, self.loop.drain()))
        return self.taken

    def row_where(self, true):
        """The first row of which that is true."""
        found = []

        def there():
            found[:] = [row for row in self.rows() if true(row)]
            return found

        wait_until(there, 10, "no such row")
        return found[0]


@pytest.fixture
def run():
    """Start a loop with a limit of the force."""
    runs = []

    def start(max_force_n=10.0):
        steps = press_step_functions(np.zeros(100_000), 1.0, GAINS)
        settings = LoopSettings(PERIOD_S, max_force_n=max_force_n, real_time=False)
        drive, loop = Drive(), CLoop(steps, settings)
        runs.append(Run(drive=drive, loop=loop, settings=settings, taken=empty_rows()))
        loop.start(drive)
        return runs[-1]

    yield start
    for each in runs:
        each.loop.ask_stop()
        each.loop.join()
        each.drive.close()


def value(row, name):
    return row[COLUMN[name]]


def test_the_log_shows_the_tool_while_paused(run):
    """Nothing is called and no force is sent, but a hand that moves the tool is seen."""
    session = run()
    session.drive.sample(0.25, 1.0)
    session.row_where(lambda row: value(row, "position_m") == 0.25)
    session.loop.pause(True)
    wait_until(lambda: session.loop.get_status().paused, 10, "not paused")
    session.drive.sample(0.5, 2.0)
    row = session.row_where(lambda row: value(row, "position_m") == 0.5)
    assert int(value(row, "call")) & (NONE | SILENT) == NONE | SILENT
    assert value(row, "returned_n") == value(row, "sent_n") == 0
    assert value(row, "measured_n") == pytest.approx(2.0)
    assert session.loop.get_status().reason == Stop.NONE


def test_what_a_lost_device_measured_last_is_not_kept(run):
    """Without a device nothing is measured, and after its return nothing until its first sample."""
    session = run()
    session.drive.sample(0.25, 3.0)
    session.row_where(lambda row: value(row, "measured_n") == pytest.approx(3.0))
    session.drive.far.close()
    wait_until(lambda: not session.loop.get_status().connected, 10, "not gone")
    at = session.loop.get_status().ticks
    wait_until(lambda: session.loop.get_status().ticks > at + 20, 10, "no ticks")
    assert np.isnan(session.rows()[at + 1 :, COLUMN["measured_n"]]).all()
    before, session.drive = session.drive, Drive()
    session.loop.attach(session.drive)
    wait_until(lambda: session.loop.get_status().connected, 10, "not back")
    at = session.loop.get_status().ticks
    wait_until(lambda: session.loop.get_status().ticks > at + 20, 10, "no ticks")
    assert np.isnan(session.rows()[at:, COLUMN["measured_n"]]).all()
    session.drive.sample(0.25, 4.0)
    session.row_where(lambda row: value(row, "measured_n") == pytest.approx(4.0))
    before.close()


@pytest.mark.parametrize("measured_n", [math.inf, -math.inf, 11.0])
@pytest.mark.parametrize("max_force_n", [10.0, math.inf])
def test_a_load_cell_beyond_the_limit_ends_it(run, measured_n, max_force_n):
    """Infinity is beyond every limit, also where none is set."""
    session = run(max_force_n)
    session.drive.sample(0.25, measured_n)
    if math.isfinite(measured_n) and math.isinf(max_force_n):
        session.row_where(lambda row: value(row, "measured_n") == pytest.approx(measured_n))
        assert session.loop.get_status().reason == Stop.NONE
        return
    wait_until(lambda: session.loop.get_status().over, 10, "does not end")
    state, row = session.loop.get_status(), session.rows()[-1]
    assert state.reason == Stop.FORCE
    assert int(value(row, "call")) & SILENT
    assert value(row, "sent_n") == 0
    line, error = why_stopped(state, row, session.settings)
    assert f"the force reached {abs(measured_n):.3g} N" in line
    assert error is not None


def test_a_load_cell_that_measures_nothing_ends_nothing(run):
    session = run()
    session.drive.sample(0.25, math.nan)
    row = session.row_where(lambda row: value(row, "position_m") == 0.25)
    assert math.isnan(value(row, "measured_n"))
    time.sleep(20 * PERIOD_S)
    assert session.loop.get_status().reason == Stop.NONE
