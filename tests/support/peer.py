"""Simulated peers as processes: started, listened to, ended."""

import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

PEERS = Path(__file__).parent / "peers"
CLI = [sys.executable, "-c", "from springpot.host.cli import main; main()"]


def cli(*words: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """What `springpot WORDS` returns and prints, as a process of its own."""
    command = [*CLI, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


class Peer:
    """A peer that runs: its URL, and the events that it has told."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.url = process.stdout.readline().strip()
        assert "://" in self.url, "the peer died: " + self.url
        self.events: list[dict[str, Any]] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def named(self, name: str) -> list[dict[str, Any]]:
        return [event for event in self.events if event["event"] == name]

    def wait_for(self, name: str, seconds: float = 10.0, more: int = 0) -> dict[str, Any]:
        """The event after `more` of its name."""
        wait_until(lambda: len(self.named(name)) > more, seconds, f"no event {name}")
        return self.named(name)[more]

    def _read(self) -> None:
        for line in self.process.stdout:
            self.events.append(json.loads(line))


def wait_until(true: Callable[[], object], seconds: float, what: str) -> None:
    until = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < until, what
        time.sleep(0.005)


@contextmanager
def peer(kind: str, *options: object) -> Iterator[Peer]:
    # A drive as it has to be set up; left alone it sends a hundred estimates a second.
    set_up = ("--rate-hz", 1000) if kind.endswith("_odrive") else ()
    command = [sys.executable, str(PEERS / f"{kind}.py"), *map(str, (*set_up, *options))]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield Peer(process)
    finally:
        process.terminate()
        process.wait(5)
        if process.stdout is not None:
            process.stdout.close()
