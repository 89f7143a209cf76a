"""A session in a browser: every frame, under a token, without the loop waiting for anyone."""

import base64
import socket
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import IO

import numpy as np
import pytest
from support.browser import answer_of

from springpot.host.devices.wire import Receiver, Sender
from springpot.host.native.loop_library import COLUMN, COLUMNS, IDLE, NONE, LoopRows
from springpot.host.page.live import LivePage, frames
from springpot.host.pages import server


def some_rows(n: int, seed: int = 1) -> LoopRows:
    rows = np.random.default_rng(seed).normal(0.0, 1.0, (n, len(COLUMNS)))
    rows[:, COLUMN["notes"]] = 64
    rows[:, COLUMN["call"]] = 0
    return rows


@pytest.fixture
def page() -> Iterator[LivePage]:
    with LivePage("<p>a page</p>") as found:
        yield found


def next_event(stream: IO[bytes]) -> tuple[str, bytes]:
    lines = [stream.readline().decode().rstrip("\n") for _ in range(3)]
    return lines[0].removeprefix("event: "), base64.b64decode(lines[1].removeprefix("data: "))


def wait_for_viewer(page: LivePage, count: int = 1) -> None:
    end_s = time.monotonic() + 10.0
    while page.viewers != count:
        assert time.monotonic() < end_s
        time.sleep(0.001)


def test_every_call_of_the_loop_comes_as_a_frame() -> None:
    rows = some_rows(50)
    rows[10:20, COLUMN["call"]] = NONE
    rows[30, COLUMN["call"]] = IDLE
    found = list(Receiver().feed(frames(Sender(), rows)))
    assert len(found) == 40
    assert [frame.values["call"] for frame in found].count(1) == 1
    sent_n = np.delete(rows, np.s_[10:20], axis=0)[:, COLUMN["sent_n"]]
    assert [frame.values["force_n"] for frame in found] == sent_n.astype(np.float32).tolist()


def test_a_browser_gets_the_page_and_then_the_rows(page: LivePage) -> None:
    assert answer_of(page.address)[1] == b"<p>a page</p>"
    with urllib.request.urlopen(page.address + "frames", timeout=10) as stream:
        wait_for_viewer(page)
        page.append(some_rows(900))
        receiver, forces = Receiver(), list[float]()
        while len(forces) < 900:
            name, content = next_event(stream)
            assert name == "message"
            forces += [frame.values["force_n"] for frame in receiver.feed(content)]
        assert receiver.crc_errors == receiver.gaps == 0
        assert forces == some_rows(900)[:, COLUMN["sent_n"]].astype(np.float32).tolist()
        page.end("stopped by the user")
        assert stream.read().decode() == "event: over\ndata: stopped by the user\n\n"
    wait_for_viewer(page, 0)


def test_nobody_without_the_token_or_from_another_site_is_answered(page: LivePage) -> None:
    called: list[str] = []
    page.actions = {"stop": lambda: called.append("stop")}
    root = page.address.rsplit("/", 2)[0]
    assert answer_of(root + "/")[0] == 404
    assert answer_of(root + "/frames")[0] == 404
    assert answer_of(root + "/guess/stop", None, "POST")[0] == 404
    assert answer_of(page.address + "stop", None, "POST", Host="evil.example")[0] == 404
    assert answer_of(page.address + "stop")[0] == 404
    assert answer_of(page.address + "other", None, "POST")[0] == 404
    assert called == []
    assert answer_of(page.address + "stop", None, "POST")[0] == 200
    assert called == ["stop"]


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "", "https://{host}", "http://{host}.evil.example",
               "http://localhost:{port}", "http://127.0.0.1"],
)  # fmt: skip
def test_no_other_page_presses_a_button(page: LivePage, origin: str) -> None:
    """Though it knew the token: a browser says where a POST is from."""
    called: list[str] = []
    page.actions = {"stop": lambda: called.append("stop")}
    host = page.address.split("/")[2]
    origin = origin.format(host=host, port=host.split(":")[1])
    assert answer_of(page.address + "stop", None, "POST", Origin=origin)[0] == 403
    assert called == []
    assert answer_of(page.address + "stop", None, "POST", Origin=f"http://{host}")[0] == 200
    assert called == ["stop"]


def connection_to(page: LivePage, content: bytes = b"") -> socket.socket:
    host, port = page.address.split("/")[2].split(":")
    found = socket.create_connection((host, int(port)), timeout=10)
    found.sendall(content)
    return found


def is_closed(connection: socket.socket) -> bool:
    """Whether the other end closed it without a word."""
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


def test_at_most_sixteen_connections_are_heard_at_once(page: LivePage) -> None:
    """However many come, and whatever they say: the others are closed, and cost no thread."""
    before = threading.active_count()
    held = []
    try:
        for k in range(60):
            held.append(connection_to(page, b"GET /guess" + b"x" * k))
            time.sleep(0.005)  # the queue of those that are not accepted yet is short
        for connection in held[16:]:
            connection.settimeout(2.0)  # less than the deadline of a request
            assert is_closed(connection)
        assert threading.active_count() <= before + 16
    finally:
        for connection in held:
            connection.close()
    end_s = time.monotonic() + 10
    while threading.active_count() > before:
        assert time.monotonic() < end_s
        time.sleep(0.01)
    assert answer_of(page.address)[1] == b"<p>a page</p>"


@pytest.mark.parametrize(
    "part",
    ["G", "GET /x HTTP/1.0\r\n", "POST /t/a HTTP/1.0\r\nX: y\r\n",
     "POST /{path}stop HTTP/1.0\r\nHost: {host}\r\nContent-Length: 8000\r\n\r\n"],
)  # fmt: skip
def test_a_request_has_one_deadline_however_it_trickles_in(
    page: LivePage, monkeypatch: pytest.MonkeyPatch, part: str
) -> None:
    monkeypatch.setattr(server, "_REQUEST_S", 0.4)
    host, path = page.address.removeprefix("http://").split("/", 1)
    with connection_to(page, part.format(host=host, path=path).encode()) as slow:
        begin_s = time.monotonic()
        slow.settimeout(0.05)
        closed = False
        while not closed:
            assert time.monotonic() - begin_s < 5, "heard for ever"
            try:
                slow.sendall(b"x")
                closed = is_closed(slow)
            except TimeoutError:
                pass
            except OSError:
                closed = True
        assert time.monotonic() - begin_s >= 0.3


def test_a_page_that_takes_nothing_costs_the_loop_nothing(page: LivePage) -> None:
    """It connects and never reads: rows are dropped, and `append` returns."""
    with urllib.request.urlopen(page.address + "frames", timeout=10):
        wait_for_viewer(page)
        rows = some_rows(100)
        for _ in range(5000):  # 22 MB of frames: more than any socket takes
            page.append(rows)
        assert sum(len(watcher.waiting) for watcher in page.watchers()) <= 64
        page.end("over")
