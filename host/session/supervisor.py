"""Looking after the device of a running loop: gone and back, silent, tripped."""

import threading
import time
from collections.abc import Callable

from springpot.codegen.errors import DeviceError, SpringpotError
from springpot.host.devices.device import DeviceRequirements, OpenedDevice
from springpot.host.devices.drivers import open_device
from springpot.host.session.c_loop import CLoop
from springpot.host.session.outcome import LoopState

_RETRY_S = 0.05


class DeviceSupervisor:
    """Reports a device that tripped, brings back one that was unplugged, gives up a silent one.

    url, requirements: how `device` was opened. reconnect_s: how long one that is gone is waited
    for. report: takes lines for people; fail: the error that ends the session.
    """

    def __init__(
        self,
        loop: CLoop,
        device: OpenedDevice,
        url: str,
        requirements: DeviceRequirements,
        reconnect_s: float,
        report: Callable[[str], None],
        fail: Callable[[SpringpotError], None],
    ) -> None:
        """Keep loop and device; nothing is watched before `poll`."""
        self.device = device
        self.url, self._requirements, self._reconnect_s = url, requirements, reconnect_s
        self._loop, self._report, self._fail = loop, report, fail
        self._reported_trips = 0
        self._fresh_s = 0.0
        self._returning: threading.Thread | None = None

    def saw_sample(self, heard_s: float) -> None:
        """A sample was among the rows up to that time of the loop."""
        self._fresh_s = heard_s

    def poll(self, state: LoopState, heard_s: float) -> None:
        """Look after the device: gone, silent, tripped.

        heard_s: time of the loop up to which its rows were read. Silence is counted by that: while
        the loop's thread locks its memory, or the whole machine stands still, nobody listens, and
        that is not the device's doing.
        """
        if not state.connected:
            if self._returning is None:
                self._returning = threading.Thread(target=self._bring_back, daemon=True)
                self._returning.start()
            return
        if state.watchdog_trips > self._reported_trips:
            self._reported_trips = state.watchdog_trips
            if state.tripped:
                error = self._loop.counts().device_error
                why = self.device.failure or (f"its error 0x{error:x}" if error else "")
                code = f" ({why})" if why else ""
                self._report(
                    f"the device switched its motor off{code}: force zero until reset (r), or stop"
                )
            else:
                self._report(
                    "no sample for the watchdog's time: force zero until reset (r), or stop"
                )
        silent_s = heard_s - self._fresh_s
        if silent_s > (self._reconnect_s or 1.0) and not state.paused and not state.tripped:
            self._fail(
                DeviceError(
                    f"{self.url}: connected but silent for {silent_s:.1f} s, force zero: restart "
                    "the device"
                )
            )

    def _bring_back(self) -> None:
        """Open a device that was unplugged again, and hand it to the loop; or end the session."""
        why = f" ({self.device.failure})" if self.device.failure else ""
        force = self.device.unreached
        if not self.device.comes_back or not self._reconnect_s:
            self._fail(DeviceError(f"{self.url}: gone{why}, {force}, stopped: plug it in"))
            return
        begin_s = time.perf_counter()
        self._report(f"{self.url}: gone{why}, {force}; waiting {self._reconnect_s:g} s for it")
        self.device.close()
        while (device := self._reopened(begin_s + self._reconnect_s)) is not None:
            self.device = device
            state = self._go_on(device)
            if state.connected:
                then = (
                    "it had tripped before: reset with r"
                    if state.tripped_before_disconnect
                    else "force ramps in"
                )
                self._report(
                    f"{self.url}: back after {time.perf_counter() - begin_s:.2f} s, {then}"
                )
                self._returning = None
                return
            if state.over:
                device.stop()
            device.close()  # it went again before its first sample

    def _reopened(self, until_s: float) -> OpenedDevice | None:
        """Open the device again until the time for that is over; then the session ends.

        None where it is given up, or nobody waits for it any more.
        """
        last: SpringpotError = DeviceError("")
        while time.perf_counter() < until_s:
            if self._loop.get_status().over:
                return None
            try:
                return open_device(self.url, self._requirements)
            except SpringpotError as error:
                last = error
                time.sleep(_RETRY_S)
        self._fail(
            DeviceError(
                f"{self.url}: gone for {self._reconnect_s:g} s, {self.device.unreached}, "
                f"stopped ({last}): plug it in and start again"
            )
        )
        return None

    def _go_on(self, device: OpenedDevice) -> LoopState:
        """The loop goes on with it: until its first sample, or until it is gone again."""
        state, samples = self._loop.get_status(), self._loop.counts().samples
        disconnects, self._reported_trips = state.disconnects, state.watchdog_trips
        self._fresh_s = state.elapsed_s
        self._loop.attach(device)
        while True:
            state = self._loop.get_status()
            came = state.connected and self._loop.counts().samples > samples
            if came or state.over or state.disconnects > disconnects:
                break
            time.sleep(0.001)
        self._fresh_s = state.elapsed_s
        return state
