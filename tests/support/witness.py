"""Tests against the clock on a machine that is not always there.

A process on each core sleeps 2 ms at a time: what it overslept, any program may have been held up.
A test marked realtime that fails in such a moment says nothing, and is done once more. One that
fails on a machine that was there has failed.
"""

import os
import select
import subprocess
import sys

import pytest
from _pytest.runner import runtestprotocol

HELD_UP_S = 0.010  # half the shortest watchdog of the tests
TRIES = 4

_SLEEPER = """
import os, sys, time
os.sched_setaffinity(0, {int(sys.argv[1])})
before_s = time.monotonic()
while True:
    time.sleep(0.002)
    now_s = time.monotonic()
    if now_s - before_s > float(sys.argv[2]):
        os.write(1, b"%12.6f\\n" % (now_s - before_s))
    before_s = now_s
"""


class MachineWitness:
    """The sleeping processes: one on each core where the system has cores to choose."""

    def __init__(self) -> None:
        cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set[int]()
        self.sleepers = [
            subprocess.Popen(
                [sys.executable, "-I", "-S", "-c", _SLEEPER, str(core), str(HELD_UP_S)],
                stdout=subprocess.PIPE,
            )
            for core in cores
        ]

    def longest_s(self) -> float:
        """The longest that one of them was held up since the last call; 0.0 where none was."""
        longest_s = 0.0
        for sleeper in self.sleepers:
            while select.select([sleeper.stdout], [], [], 0)[0]:
                longest_s = max(longest_s, float(os.read(sleeper.stdout.fileno(), 13)))
        return longest_s

    def close(self) -> None:
        for sleeper in self.sleepers:
            sleeper.kill()
            sleeper.communicate()


class RealtimeTries:
    """A plugin of pytest: the tries of tests that are marked realtime."""

    def __init__(self) -> None:
        self._witness: MachineWitness | None = None
        self._again: list[str] = []

    def pytest_runtest_protocol(
        self, item: pytest.Item, nextitem: pytest.Item | None
    ) -> bool | None:
        if item.get_closest_marker("realtime") is None:
            return None
        item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
        for report in self._tried(item, nextitem):
            item.ihook.pytest_runtest_logreport(report=report)
        item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
        return True

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        for line in self._again:
            terminalreporter.write_line(f"TRIED AGAIN {line}")

    def pytest_unconfigure(self) -> None:
        if self._witness is not None:
            self._witness.close()

    def _tried(self, item: pytest.Item, nextitem: pytest.Item | None) -> list[pytest.TestReport]:
        self._witness = self._witness or MachineWitness()
        for left in reversed(range(TRIES)):
            self._witness.longest_s()
            reports = runtestprotocol(item, nextitem=nextitem, log=False)
            held_up_s = self._witness.longest_s()
            if not left or not held_up_s or not any(report.failed for report in reports):
                break
            held_up = f"failed while the machine was held up for {1e3 * held_up_s:.0f} ms"
            self._again.append(f"{item.nodeid}: {held_up}")
        return reports
