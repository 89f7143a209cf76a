"""A session shown in a browser on this machine: frames out, STOP and RESET in.

The loop never waits for it: rows are taken where the log takes them, in batches, and a page that is
slow, closed or hung loses the oldest.
"""

import base64
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from pathlib import Path

from springpot.host.devices.wire import Sender, constant
from springpot.host.native.loop_library import COLUMN, IDLE, NONE, LoopRows
from springpot.host.page.press_page import session_page
from springpot.host.pages.server import Answer, PageEvent, PageServer, PageWatcher

BATCH_S = 0.033
_MAX_WAITING = 64  # batches of rows: some seconds
_MAX_FRAMES = 400  # in an event: some 16 kB

Actions = Mapping[str, Callable[[], None]]


class _RowsWaiting(PageWatcher):
    """Rows that wait for one page; the oldest are dropped."""

    def __init__(self) -> None:
        self._sender = Sender()
        self.waiting: deque[LoopRows] = deque(maxlen=_MAX_WAITING)

    def news(self) -> Iterator[PageEvent]:
        for rows in [self.waiting.popleft() for _ in range(len(self.waiting))]:
            for begin in range(0, len(rows), _MAX_FRAMES):
                content = frames(self._sender, rows[begin : begin + _MAX_FRAMES])
                yield "message", base64.b64encode(content).decode()


@contextmanager
def opened_page(
    folder: Path, accept_edited: bool, say: Callable[[str], None]
) -> Iterator["LivePage"]:
    """Serve the page of a session with an emitted folder, for `springpot run`."""
    with LivePage(session_page(folder, accept_edited)) as page:
        say(f"page: {page.address}")
        yield page


class LivePage(PageServer[_RowsWaiting]):
    """Serves the page of one session. `append` takes its rows; `actions`: "stop" and "reset"."""

    def __init__(self, text: str) -> None:
        """text: of `session_page`."""
        super().__init__(text, "frames", BATCH_S)
        self.actions: Actions = {}

    def append(self, rows: LoopRows) -> None:
        """Take rows of the loop for every open page; never waits."""
        for watcher in self.watchers():
            watcher.waiting.append(rows)

    def watcher(self) -> _RowsWaiting:
        return _RowsWaiting()

    def posted(self, name: str, body: bytes) -> Answer:
        if name not in self.actions:
            return HTTPStatus.NOT_FOUND, ""
        self.actions[name]()
        return HTTPStatus.OK, ""


def frames(sender: Sender, rows: LoopRows) -> bytes:
    """Encode rows of a loop as a board that renders sends them; skip those without a call."""
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
