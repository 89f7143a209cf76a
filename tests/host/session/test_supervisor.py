"""Looking after a device that does not stay: everything but the devices and the loop is real."""

import threading
import time
from types import SimpleNamespace

import pytest
from support.peer import wait_until

from springpot.codegen.errors import DeviceError
from springpot.host.session import supervisor
from springpot.host.session.loop import LinkCounts, LoopState
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
def lose(monkeypatch):
    """Lose a device; later ones are opened as given. Returns once back, or given up."""

    def run(loop, later, failure=""):
        told, over = [], threading.Event()
        monkeypatch.setattr(supervisor, "open_device", lambda *_: later())
        looking = DeviceSupervisor(loop, fake_device(failure=failure), "serial://x", None, 0.2,
                                   told.append, lambda e: (told.append(e), over.set()))  # fmt: skip
        looking.poll(LoopState(connected=0, disconnects=1), 0.0)
        wait_until(lambda: over.is_set() or looking._returning is None, 10, "waits for ever")
        return told

    return run


def test_back(lose):
    told = lose(FakeLoop(stays=True), fake_device)
    assert "back after" in told[-1]


def test_a_device_that_goes_before_its_first_sample_is_given_up(lose):
    loop = FakeLoop(stays=False)
    told = lose(loop, fake_device)
    assert loop.attached > 1
    assert isinstance(told[-1], DeviceError)
    assert "gone for 0.2 s, force zero, stopped" in str(told[-1])
    assert not any("back after" in str(line) for line in told)


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
    assert not failed
    supervised.poll(here, 0.4)
    assert "connected but silent for 0.2 s, force zero" in str(failed[0])


def test_a_loop_that_stands_still_makes_no_device_silent(looking):
    supervised, failed = looking
    supervised.poll(LoopState(connected=1), 0.0)
    time.sleep(0.25)
    supervised.poll(LoopState(connected=1), 0.0)
    assert not failed
