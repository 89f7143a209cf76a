"""A device that sends at another rate than the scene's: refused before it is armed, or stopped."""

import pytest
from support.peer import peer
from support.sessions import ended

from springpot.codegen.errors import DeviceError
from springpot.host.cli import exit_status
from springpot.host.devices import device as device_module
from springpot.host.devices.device import require_sample_rate
from springpot.host.native.c_library import Stop


@pytest.fixture
def count_of(monkeypatch):
    """Make a count that waits on a clock of its own: samples of each window, given as rates."""
    clock = [0.0]
    monkeypatch.setattr(device_module.time, "monotonic", lambda: clock[0])

    def make(*rates_hz):
        rates, windows_s = iter(rates_hz), []

        def count(until_s):
            windows_s.append(until_s - clock[0])
            clock[0] = until_s
            return round(windows_s[-1] * next(rates))

        return count, windows_s

    return make


@pytest.mark.parametrize("rates_hz", [(1000,), (900,), (3000,), (500, 1000), (0, 0, 990)])
def test_enough_samples(count_of, rates_hz):
    count, windows_s = count_of(*rates_hz)
    require_sample_rate("x", 1000, count, "do this")
    assert windows_s == pytest.approx([0.1] * len(rates_hz))


@pytest.mark.parametrize("rates_hz", [(100, 100, 100), (880, 880, 880), (0, 10, 0)])
def test_too_few_samples(count_of, rates_hz):
    count, _ = count_of(*rates_hz)
    told = f"x: sends {max(rates_hz)} samples a second, the scene runs at 1000 Hz: do this"
    with pytest.raises(DeviceError, match=told):
        require_sample_rate("x", 1000, count, "do this")


def test_a_silent_device_is_the_sessions_matter(count_of):
    count, _ = count_of(0, 0, 0)
    require_sample_rate("x", 1000, count, "do this")


@pytest.mark.realtime
def test_a_rate_that_falls_in_a_session(folder):
    with peer("serial_device", "--thin-after", 0.4) as device:
        session = ended(folder, device.url)
        assert device.wait_for("stop")["force_n"] == 0
    assert session.state.reason == Stop.RATE
    assert "for a fifth of the last 100 periods of 1 ms no sample came" in session.line
    assert "set its firmware to 1000 Hz" in session.line
    assert exit_status(session.error) == 5
