"""Serve one page on localhost behind an unguessable token, and push events to every open browser.

Nobody waits for a page: what is new is asked of its watcher every `every_s`, in the thread that
writes to that page, and a page that takes nothing for some seconds is gone. A stranger on this
machine costs a few threads for some seconds: connections are counted, requests have a deadline.
"""

import io
import re
import secrets
import socket
import sys
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Iterable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Generic, Self, TypeVar

_SEND_S = 5.0  # a page that takes nothing for so long is gone
_REQUEST_S = 5.0  # for the whole of a request, however it trickles in
_MAX_CONNECTIONS = 16  # at once; more are closed unheard
_ALIVE_S = 1.0  # between signs of life: a closed page is found out by writing to it
_POLL_S = 0.05  # of the end
_MAX_BODY = 8192  # bytes that a page may send

PageEvent = tuple[str, str]  # its name, and its data: one line
Answer = tuple[HTTPStatus, str]


class PageWatcher(ABC):
    """One page that looks."""

    @abstractmethod
    def news(self) -> Iterable[PageEvent]:
        """Return what this page has not got yet; called by one thread."""


W = TypeVar("W", bound=PageWatcher)


class PageServer(ABC, Generic[W]):
    """Serves one page; its events come under `stream`. As a context manager."""

    def __init__(self, text: str, stream: str, every_s: float) -> None:
        self._text = text.encode()
        self._stream_name, self._every_s = stream, every_s
        self._token = secrets.token_urlsafe(16)
        self._looking: set[W] = set()
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._over = ""
        self._server = _Server(("127.0.0.1", 0), _Request)
        self._server.page = self
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=[_POLL_S], daemon=True
        )

    @abstractmethod
    def watcher(self) -> W:
        """Return a new one, for a page that begins to look."""

    @abstractmethod
    def posted(self, name: str, body: bytes) -> Answer:
        """Return what a page gets that sent a body to a name; any page, any thread."""

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{self._host}/{self._token}/"

    @property
    def viewers(self) -> int:
        """How many pages look."""
        return len(self.watchers())

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._closing.set()
        self._server.shutdown()
        self._server.server_close()

    def end(self, line: str) -> None:
        """Tell those who look why there will be no more."""
        self._over = line.replace("\n", " ")
        self._closing.set()

    def watchers(self) -> list[W]:
        """Return those of all pages that look."""
        with self._lock:
            return list(self._looking)

    @property
    def _host(self) -> str:
        return f"127.0.0.1:{self._server.server_address[1]}"

    def answer(self, request: "_Request") -> None:
        """One request; anything but the page's own finds nothing here."""
        _, token, name = [*request.path.split("/", 2), "", ""][:3]
        known = secrets.compare_digest(token.encode(), self._token.encode())
        # A browser says whose page sends; what is no browser says nothing.
        own = request.headers.get("Origin", f"http://{self._host}") == f"http://{self._host}"
        if not known or request.headers.get("Host") != self._host:
            request.send_error(HTTPStatus.NOT_FOUND)
        elif request.command == "POST" and not own:
            request.send_error(HTTPStatus.FORBIDDEN)
        elif request.command == "POST":
            body = request.body()
            status, text = (HTTPStatus.BAD_REQUEST, "") if body is None else self.posted(name, body)
            if status == HTTPStatus.OK:
                request.reply("text/plain; charset=utf-8", text.encode())
            else:
                request.send_error(status)
        elif name == "":
            request.reply("text/html; charset=utf-8", self._text)
        elif name == self._stream_name:
            self._stream(request)
        else:
            request.send_error(HTTPStatus.NOT_FOUND)

    def _stream(self, request: "_Request") -> None:
        watcher = self.watcher()
        with self._lock:
            self._looking.add(watcher)
        try:
            request.begin("text/event-stream")
            closed, silent_s = False, 0.0
            while not closed:
                closed = self._closing.wait(self._every_s)
                silent_s += self._every_s
                for name, data in watcher.news():
                    request.event(name, data)
                    silent_s = 0.0
                if silent_s >= _ALIVE_S:
                    request.event("alive", "")
                    silent_s = 0.0
            request.event("over", self._over)
        except OSError:
            pass  # the page was closed, or is too slow
        finally:
            with self._lock:
                self._looking.discard(watcher)


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False
    page: PageServer[Any]

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._room = threading.BoundedSemaphore(_MAX_CONNECTIONS)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Begin a thread for it, if there is room."""
        if self._room.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer it, and make room again."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A page that leaves in the middle of a request is no fault of the session."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _UntilDeadline(io.RawIOBase):
    """What a socket gives until a time; then its reader gets a TimeoutError."""

    def __init__(self, connection: socket.socket, until_s: float) -> None:
        self._connection, self._until_s = connection, until_s

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        """Wait for what is left of the time at most."""
        left_s = self._until_s - time.monotonic()
        if left_s <= 0:
            raise TimeoutError("half a request")
        self._connection.settimeout(left_s)
        try:
            return self._connection.recv_into(buffer)
        finally:
            self._connection.settimeout(_SEND_S)


class _Request(BaseHTTPRequestHandler):
    server: _Server
    timeout = _SEND_S
    server_version, sys_version = "springpot", ""

    def setup(self) -> None:
        """Read the request until its deadline."""
        super().setup()
        until_s = time.monotonic() + _REQUEST_S
        self.rfile = io.BufferedReader(_UntilDeadline(self.connection, until_s))

    def do_GET(self) -> None:
        self.server.page.answer(self)

    def do_POST(self) -> None:
        self.server.page.answer(self)

    def log_message(self, *_args: Any) -> None:
        """Nothing: the terminal shows the session."""

    def body(self) -> bytes | None:
        """What came with the request; None where that is too much, or has no length."""
        size = self.headers.get("Content-Length", "0")
        if not re.fullmatch("[0-9]{1,9}", size) or int(size) > _MAX_BODY:
            return None
        return self.rfile.read(int(size))

    def begin(self, kind: str, size: int | None = None) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        if size is not None:
            self.send_header("Content-Length", str(size))
        self.end_headers()

    def reply(self, kind: str, content: bytes) -> None:
        self.begin(kind, len(content))
        self.wfile.write(content)

    def event(self, name: str, data: str) -> None:
        self.wfile.write(f"event: {name}\ndata: {data}\n\n".encode())
