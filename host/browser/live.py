"""A session shown in a browser on this machine: frames out, STOP and RESET in.

The loop never waits for it: rows are taken where the log takes them, in batches, and a page that is
slow, closed or hung loses the oldest. It listens on the loopback address alone, and answers only
under a token that nobody can guess.
"""

import base64
import secrets
import threading
from collections import deque
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Self

from springpot.host.devices.wire import Sender, constant
from springpot.host.native.loop_library import COLUMN, IDLE, NONE, LoopRows

BATCH_S = 0.033
_MAX_WAITING = 64  # batches of rows: some seconds
_MAX_FRAMES = 400  # in an event: some 16 kB
_SEND_S = 5.0  # a page that takes nothing for so long is gone

Actions = Mapping[str, Callable[[], None]]


class LivePage:
    """Serves the page of one session. `append` takes its rows; `actions`: "stop" and "reset"."""

    def __init__(self, text: str) -> None:
        """text: of `session_page`."""
        self.actions: Actions = {}
        self._text = text.encode()
        self._token = secrets.token_urlsafe(16)
        self._viewers: set[_Viewer] = set()
        self._lock = threading.Lock()
        self._over = ""
        self._server = _Server(("127.0.0.1", 0), _Request)
        self._server.page = self
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{self._host}/{self._token}/"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._server.shutdown()
        self._server.server_close()

    def append(self, rows: LoopRows) -> None:
        """Rows of the loop, for whoever looks; never waits."""
        for viewer in self._looking():
            viewer.put(rows)

    def end(self, line: str) -> None:
        """Tell those who look why the session ended."""
        self._over = line.replace("\n", " ")
        for viewer in self._looking():
            viewer.close()

    @property
    def _host(self) -> str:
        return f"127.0.0.1:{self._server.server_address[1]}"

    def _looking(self) -> list["_Viewer"]:
        with self._lock:
            return list(self._viewers)

    def answer(self, request: "_Request", method: str) -> None:
        """One request; anything but the page's own finds nothing here."""
        host, path = request.headers.get("Host"), request.path
        name = path.removeprefix(f"/{self._token}/")
        if host != self._host or name == path:
            request.send_error(HTTPStatus.NOT_FOUND)
        elif method == "GET" and name == "":
            request.reply("text/html; charset=utf-8", self._text)
        elif method == "GET" and name == "frames":
            self._stream(request)
        elif method == "POST" and name in self.actions:
            self.actions[name]()
            request.reply("text/plain", b"")
        else:
            request.send_error(HTTPStatus.NOT_FOUND)

    def _stream(self, request: "_Request") -> None:
        viewer = _Viewer()
        with self._lock:
            self._viewers.add(viewer)
        try:
            request.connection.settimeout(_SEND_S)
            request.begin("text/event-stream")
            sender = Sender()
            while not (viewer.closed or self._over):
                for rows in viewer.take(BATCH_S):
                    for begin in range(0, len(rows), _MAX_FRAMES):
                        content = frames(sender, rows[begin : begin + _MAX_FRAMES])
                        request.event(base64.b64encode(content).decode())
            request.event(self._over, "over")
        except OSError:
            pass  # the page was closed, or is too slow
        finally:
            with self._lock:
                self._viewers.discard(viewer)


class _Viewer:
    """Rows that wait for one page; the oldest are dropped."""

    def __init__(self) -> None:
        self._waiting: deque[LoopRows] = deque(maxlen=_MAX_WAITING)
        self._closing = threading.Event()

    @property
    def closed(self) -> bool:
        return self._closing.is_set()

    def put(self, rows: LoopRows) -> None:
        self._waiting.append(rows)

    def close(self) -> None:
        self._closing.set()

    def take(self, within_s: float) -> list[LoopRows]:
        """What has come, after so long."""
        self._closing.wait(within_s)
        return [self._waiting.popleft() for _ in range(len(self._waiting))]


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False
    page: LivePage


class _Request(BaseHTTPRequestHandler):
    server: _Server

    def do_GET(self) -> None:
        self.server.page.answer(self, "GET")

    def do_POST(self) -> None:
        self.server.page.answer(self, "POST")

    def log_message(self, *_args: Any) -> None:
        """Nothing: the terminal shows the session."""

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

    def event(self, text: str, name: str = "message") -> None:
        self.wfile.write(f"event: {name}\ndata: {text}\n\n".encode())


def frames(sender: Sender, rows: LoopRows) -> bytes:
    """Rows of a loop as a board that renders would send them; rows without a call are left out."""
    kept = rows[(rows[:, COLUMN["call"]].astype(int) & NONE) == 0]
    names = ("position_m", "velocity_mps", "dt_s", "sent_n", "notes", "call")
    columns = [kept[:, COLUMN[name]].tolist() for name in names]
    idle = constant("IDLE")
    return b"".join(
        sender.encode(
            "rendered",
            call=idle if int(call) & IDLE else 0,
            position_m=position_m,
            velocity_mps=velocity_mps,
            dt_s=dt_s,
            force_n=force_n,
            notes=int(notes) & 0xFF,
        )
        for position_m, velocity_mps, dt_s, force_n, notes, call in zip(*columns, strict=True)
    )
