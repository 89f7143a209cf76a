"""springpot serial: open, compare versions, model and rates, start; then the loop takes over."""

import contextlib
import math
import time
from collections.abc import Callable, Iterator

import serial

from springpot.codegen.errors import DeviceError
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.types import CData, JsonObject
from springpot.host.devices.device import (
    FORCE_ZERO,
    ZERO_S,
    DeviceRequirements,
    OpenedDevice,
    proved_watchdog_s,
    require_sample_rate,
    weakness_sentence,
)
from springpot.host.devices.drivers import Address
from springpot.host.devices.serial_port import open_port, require_fast_adapter
from springpot.host.devices.wire import Frame, Receiver, Sender, constant, layout

BAUD = 921600
_ASK_S, _AGAIN_S, _LOOK_S = 2.0, 0.05, 0.0005
# A device's watchdog is asked to be quicker than what is proved: its samples say so a little later.
_WATCHDOG_S = 0.75 * ZERO_S


class SerialDevice(OpenedDevice):
    """A device of springpot serial: position in, force out."""

    unreached = FORCE_ZERO  # by its own watchdog, which START sets

    def __init__(self, address: Address, requirements: DeviceRequirements) -> None:
        """Open and start it. Raises DeviceError with one line for whatever is wrong."""
        address.require_known(("baud", "n_per_unit" if requirements.senses else "surface_mm"))
        self.address, self.requirements = address, requirements
        baud = address.whole("baud", BAUD, 1200, 12_000_000)
        require_fast_adapter(address.place, requirements.rate_hz)
        self.port: serial.Serial = open_port(address.place, baud)
        self.sender, self.receiver = Sender(), Receiver()
        self._link_memory: CData = None
        try:
            self.hello = self._hello()
            self._check(self.hello)
            self.command("PRESS" if requirements.presses else "START")
            if not requirements.senses:
                self._prove_watchdog()
            self._require_rate()
        except BaseException:
            self.close()
            raise

    @property
    def watchdog_s(self) -> float:
        """Silence of this host after which the device ends its force by itself."""
        return min(self.requirements.watchdog_s, _WATCHDOG_S)

    @property
    def rate_advice(self) -> str:
        return (
            f"set its firmware to {self.requirements.rate_hz:g} Hz, raise ?baud=, look for noise "
            "or a loose cable if frames are damaged or missing, or render a scene of its rate "
            "([runtime] rate_hz, where the model allows it)"
        )

    def link(self, library: CLibrary) -> CData:
        """Make the link by which the loop in C speaks on the port."""
        self._link_memory = library.memory(library.c.sp_link_serial_size())
        surface_m = (
            self.address.number("surface_mm", 1e3 * self.requirements.surface_m, -1e4, 1e4) / 1e3
        )
        return library.c.sp_link_serial_init(
            self._link_memory,
            self.port.fd,
            surface_m,
            self.watchdog_s,
            self.requirements.rate_hz,
            self.sender.sequence,
        )

    def stop(self) -> None:
        """No force, acknowledged; a device that is gone has its own watchdog for that."""
        with contextlib.suppress(DeviceError, OSError):
            self.command("STOP", patience_s=0.3)

    def close(self) -> None:
        self.port.close()

    def command(self, action: str, patience_s: float = _ASK_S) -> None:
        """Send a command until it is acknowledged. Raises DeviceError where it is not."""
        # ASK before it: the device forgets the sequence, and the loop's numbers are ahead.
        asked = self.sender.encode("ask", layout=layout()) if action == "STOP" else b""
        sequence = self.sender.sequence
        content = asked + self.sender.encode(
            "command",
            action=constant(action),
            watchdog_s=self.watchdog_s,
            rate_hz=self.requirements.rate_hz,
        )

        def is_answer(frame: Frame) -> bool:
            return frame.name == "ack" and frame.values["command"] == sequence

        ack = self._ask(lambda: content, is_answer, patience_s)
        if ack is None:
            raise DeviceError(
                f"{self.address.url}: {action} was not acknowledged within {patience_s:g} s: "
                "restart the device"
            )
        if ack["refused"]:
            raise DeviceError(
                f"{self.address.url}: the device refuses {action} at "
                f"{self.requirements.rate_hz:g} Hz, watchdog {1e3 * self.watchdog_s:g} ms: change "
                "runtime.rate_hz or guard.watchdog_ms in the scene, or flash the firmware of this "
                "springpot"
            )

    def frames(self) -> list[Frame]:
        """Frames that have come since the last call (before the loop takes over)."""
        try:
            return list(self.receiver.feed(self.port.read(4096)))
        except (OSError, serial.SerialException, TypeError) as error:
            raise DeviceError(f"{self.address.url}: went away ({error}): plug it in") from None

    def send(self, name: str, **values: CData) -> None:
        """Send one message (before the loop takes over)."""
        self.write(self.sender.encode(name, **values))

    def write(self, content: bytes) -> None:
        """Send the bytes of whole frames."""
        try:
            self.port.write(content)
        except (OSError, serial.SerialException) as error:
            raise DeviceError(f"{self.address.url}: went away ({error}): plug it in") from None

    def _frames_until(self, until_s: float) -> Iterator[Frame]:
        while time.perf_counter() < until_s:
            time.sleep(_LOOK_S)
            yield from self.frames()

    def _ask(
        self, send: Callable[[], bytes], is_answer: Callable[[Frame], bool], patience_s: float
    ) -> JsonObject | None:
        """Send a question until it is answered; None without an answer. A frame may be lost."""
        until_s = time.perf_counter() + patience_s
        while (now_s := time.perf_counter()) < until_s:
            self.write(send())
            for frame in self._frames_until(min(now_s + _AGAIN_S, until_s)):
                if is_answer(frame):
                    return frame.values
        return None

    def _require_rate(self) -> None:
        """Raise DeviceError for a device that sends too few samples."""
        try:
            require_sample_rate(
                self.address.url, self.requirements.rate_hz, self._samples_until, self.rate_advice
            )
        except DeviceError:
            self.stop()
            raise

    def _samples_until(self, until_s: float) -> int:
        frames = self._frames_until(until_s)
        return sum(frame.name == "sample" and not frame.old for frame in frames)

    def _prove_watchdog(self) -> None:
        """Prove the watchdog by silence: refuse a device that does not say in time that it tripped.

        One force of zero comes before. RESET makes the device ready again.
        """
        found_s = proved_watchdog_s(self._silent_until_tripped_s)
        if found_s <= ZERO_S:
            return
        self.command("STOP")
        reaction = "never" if math.isinf(found_s) else f"after {found_s:.2f} s"
        raise DeviceError(
            f"{self.address.url}: without forces from here the device trips {reaction}, at most "
            f"{ZERO_S:g} s are accepted: its firmware must keep COMMAND's watchdog_s, and set "
            "TRIPPED in its samples"
        )

    def _silent_until_tripped_s(self) -> float:
        """Be silent after a force of zero; return the seconds until the device has tripped."""
        self.send("force", force_n=0.0)
        sent_s, took_s = time.perf_counter(), math.inf
        for frame in self._frames_until(sent_s + 2 * ZERO_S):
            if frame.name == "sample" and frame.values["status"] & constant("TRIPPED"):
                took_s = time.perf_counter() - sent_s
                break
        self.command("RESET")
        return took_s

    def _hello(self) -> JsonObject:
        """Ask the device who it is: version, limits, hash of its scene."""
        hello = self._ask(
            lambda: self.sender.encode("ask", layout=layout()),
            lambda frame: frame.name == "hello",
            _ASK_S,
        )
        if hello is not None:
            return hello
        url = self.address.url
        counts = self.receiver.counts
        if counts.other_versions:
            raise DeviceError(
                f"{url}: speaks protocol version {counts.other_version}, this springpot "
                f"version {constant('VERSION')}: flash the firmware of this springpot"
            )
        if counts.crc_errors > 3:
            raise DeviceError(f"{url}: only damaged frames come: check ?baud= and the cable")
        raise DeviceError(
            f"{url}: no answer in {_ASK_S:g} s: is it a springpot device, and running?"
        )

    def _check(self, hello: JsonObject) -> None:
        """Refuse a device with other messages, or of less force than is required."""
        url, required = self.address.url, self.requirements
        if hello["layout"] != layout():
            raise DeviceError(
                f"{url}: its messages are laid out otherwise ({hello['layout']:08x}, here "
                f"{layout():08x}): flash the firmware of this springpot"
            )
        if hello["max_n"] < required.max_n * (1 - 1e-6):
            raise weakness_sentence(
                url, f"gives at most {hello['max_n']:g} N", required, hello["max_n"]
            )
