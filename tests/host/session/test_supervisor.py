"""Looking after a device that does not stay: everything but the devices and the loop is real."""

import contextlib
import time
from types import SimpleNamespace
from unittest import mock

import pytest

from springpot.host.session.outcome import LinkCounts, LoopState
from springpot.host.session.runner import SessionRunner
from springpot.host.session.supervisor import DeviceSupervisor


class FakeLoop:
    """stays: whether a device that is attached is still there when somebody looks."""

    def __init__(self, stays):
        self.stays, self.attached = stays, 0

    def attach(self, _device):
        self.attached += 1

    def get_status(self):
        gone = not (self.stays and self.attached)
        return LoopState(connected=not gone, disconnects=1 + (0 if self.stays else self.attached))

    def counts(self):
        return LinkCounts(samples=self.attached if self.stays else 0)


def fake_device(failure=""):
    return SimpleNamespace(comes_back=True, failure=failure, unreached="force zero",
                           close=lambda: None)  # fmt: skip


@pytest.fixture
def looking():
    """A supervisor of a device that is there, and what it failed with."""
    failed = []
    return DeviceSupervisor(FakeLoop(stays=True), fake_device(), "serial://x", None, 0.2,
                            failed.append, failed.append), failed  # fmt: skip


def test_silence_is_counted_by_the_loop(looking):
    supervised, failed = looking
    here = LoopState(connected=1)
    supervised.poll(here, 0.19)
    supervised.saw_sample(0.19)
    supervised.poll(here, 0.38)
    supervised.poll(LoopState(connected=1, paused=1), 9.0)
    supervised.poll(LoopState(connected=1, tripped=1), 9.0)
    assert not failed
    supervised.poll(here, 0.4)
    assert "connected but silent for 0.2 s, force zero" in str(failed[0])


def test_a_loop_that_stands_still_makes_no_device_silent(looking):
    supervised, failed = looking
    supervised.poll(LoopState(connected=1), 0.0)
    time.sleep(0.25)
    supervised.poll(LoopState(connected=1), 0.0)
    assert not failed


def test_what_tripped_while_the_device_was_gone_is_not_told(looking):
    supervised, told = looking
    supervised._loop.get_status = lambda: LoopState(connected=1, watchdog_trips=1)
    supervised.poll(supervised._go_on(fake_device()), 0.0)
    assert not told
    supervised.poll(LoopState(connected=1, watchdog_trips=2), 0.0)
    assert told == ["no sample for the watchdog's time: force zero until reset (r), or stop"]


def test_what_comes_back_after_the_end_gives_no_force(looking):
    supervised, failed = looking
    loop, late = supervised._loop, mock.Mock()
    loop.get_status = lambda: LoopState(connected=0, over=loop.attached)
    with mock.patch("springpot.host.session.supervisor.open_device", return_value=late):
        supervised._bring_back()
    assert late.mock_calls == [mock.call.stop(), mock.call.close()] and len(failed) == 1


def test_an_impatient_second_ctrl_c_leaves_no_force():
    device = mock.Mock(stop=mock.Mock(side_effect=[KeyboardInterrupt, KeyboardInterrupt, None]))
    session = SessionRunner(None, "serial://x", None, None)
    session._supervisor = SimpleNamespace(device=device)
    with contextlib.suppress(KeyboardInterrupt):
        session.close()
    assert device.mock_calls == [mock.call.stop()] * 3 + [mock.call.close()]
