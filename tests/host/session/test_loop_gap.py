"""A loop that was kept away: the samples that waited for it are no silence of the device."""

import itertools
import socket
import time
from typing import Any

import numpy as np
import pytest

from springpot.host.devices.wire import Sender, constant
from springpot.host.native.c_library import CLibrary
from springpot.host.native.loop_library import loop_library
from springpot.host.recording.indentation import trip_error
from springpot.host.session.c_loop import CLoop
from springpot.host.session.loop import LoopSettings, LoopState
from springpot.host.session.step_functions import StepFunctions

PERIOD_S = 1e-3
GAP_AT, GAP_S = 20, 0.2  # ten times what a session's watchdog allows


class Steps:
    """A device that sends a sample each period, and a scene of which one call takes long."""

    comes_back = False

    def __init__(self) -> None:
        self.library = loop_library("double")
        self.near, self.far = socket.socketpair()
        self.near.setblocking(False)
        self.sender, self.sent, self.begin_s = Sender(), itertools.count(), 0.0
        self.calls: list[str] = []
        self.gap_at = 0  # calls before the gap
        self.positions: list[float] = []
        ffi = self.library.ffi
        self.kept = (
            ffi.callback("int(void *, double, double, double *)", self.step),
            ffi.callback("int(void *, double, double *)", self.idle),
            ffi.callback("void(void *)", lambda _state: None),
        )

    def steps(self) -> StepFunctions:
        step, idle, reset = (
            int(self.library.ffi.cast("uintptr_t", function)) for function in self.kept
        )
        return StepFunctions(self.library, step, idle, reset, state=0, kept=self.kept)

    def link(self, library: CLibrary) -> Any:
        self.memory = library.memory(library.c.sp_link_serial_size())
        self.begin_s = time.monotonic()
        self.feed()
        return library.c.sp_link_serial_init(
            self.memory, self.near.fileno(), 0.0, 0.02, 1 / PERIOD_S, 0
        )

    def stop(self) -> None:
        """Nothing to stop."""

    def close(self) -> None:
        self.near.close()
        self.far.close()

    def feed(self) -> None:
        """Send what a device has sent by now; the first at once."""
        due = 1 + int((time.monotonic() - self.begin_s) / PERIOD_S)
        frames = []
        while (number := next(self.sent)) < due:
            frames.append(
                self.sender.encode(
                    "sample", status=constant("RUNNING"), position_m=1e-6 * number,
                    velocity_mps=0.0, measured_n=0.0,
                )
            )  # fmt: skip
        self.sent = itertools.count(number)
        self.far.sendall(b"".join(frames))

    def step(self, _state: Any, position_m: float, _velocity: float, force_n: Any) -> int:
        self.calls.append("step")
        self.positions.append(position_m)
        if not self.gap_at and len(self.calls) >= GAP_AT:
            self.gap_at = len(self.calls)
            time.sleep(GAP_S)
        self.feed()
        force_n[0] = 0.0
        return 0

    def idle(self, _state: Any, _dt_s: float, force_n: Any) -> int:
        self.calls.append("idle")
        self.feed()
        force_n[0] = 0.0
        return 0


def test_a_trip_names_who_was_late() -> None:
    silent = trip_error("serial://x", LoopState(watchdog_trips=1, latched=1))
    assert "x: silent for 20 ms while pressing" in str(silent)
    busy = trip_error("serial://x", LoopState(watchdog_trips=1, tripped=1, late=36))
    assert "x: switched its motor off: no force reached it for 20 ms" in str(busy)
    assert "36 periods began late: end other programs" in str(busy)


@pytest.mark.realtime
def test_samples_that_waited_are_used_one_a_period() -> None:
    device = Steps()
    loop = CLoop(device.steps(), LoopSettings(PERIOD_S, seconds=0.5, real_time=False))
    loop.start(device)
    loop.join()
    device.close()
    assert device.gap_at
    made_up = device.calls[device.gap_at : device.gap_at + round(GAP_S / PERIOD_S) - 5]
    assert len(made_up) == 195
    assert made_up.count("idle") == 0
    begin = device.calls[: device.gap_at].count("step")
    steps = np.diff(device.positions[begin : begin + 190])
    np.testing.assert_allclose(steps, 1e-6, rtol=0.01)  # in order, none left out
