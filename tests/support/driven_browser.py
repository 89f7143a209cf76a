"""A headless browser driven through the DevTools protocol, over two pipes: time is real there."""

import contextlib
import json
import os
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from support.browser import CHROMIUM

_PATIENCE_S = 60.0


class DrivenBrowser:
    """One page. `call` sends a method of the protocol, `value` computes in the page."""

    def __init__(self, to: int, back: int) -> None:
        self._to, self._back = to, back
        self._sent = 0
        self._unread = b""
        self._session = ""
        self.errors: list[str] = []
        self.requests: list[str] = []  # addresses
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)[
            "sessionId"
        ]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._sent += 1
        message = {"id": self._sent, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            found = self._next()
            if found.get("id") == self._sent:
                assert "error" not in found, found
                return dict(found["result"])

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._unread:
            self._unread += os.read(self._back, 1 << 16)
        text, self._unread = self._unread.split(b"\0", 1)
        found: dict[str, Any] = json.loads(text)
        if found.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
            self.errors.append(json.dumps(found["params"]))
        if found.get("method") == "Network.requestWillBeSent":
            self.requests.append(found["params"]["request"]["url"])
        return found

    def open(self, address: str, width: int = 1600, height: int = 1200) -> None:
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)  # fmt: skip
        began = "performance.timeOrigin"
        before = self.value(began)  # until the new page answers, the one before it does
        self.call("Page.navigate", url=address)
        self.until(f"{began} !== {before}")

    def open_ready(self, address: str, width: int = 1600, height: int = 1200) -> None:
        """Open a page that presses, and wait until it is ready."""
        self.open(address, width, height)
        self.until("document.body !== null && document.body.classList.contains('ready')")

    def text(self, name: str) -> str:
        """The words of an element."""
        return str(self.value(f"document.getElementById('{name}').textContent"))

    def box(self, name: str) -> list[float]:
        """Left, top, width and height of an element, pixels."""
        found: list[float] = self.value(
            f"(() => {{ const box = document.getElementById('{name}').getBoundingClientRect();"
            " return [box.left, box.top, box.width, box.height]; })()"
        )
        return found

    def value(self, expression: str) -> Any:
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                          awaitPromise=True)  # fmt: skip
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def until(self, expression: str) -> None:
        """Wait until it holds in the page."""
        self.wait_for(lambda: bool(self.value(expression)), expression)

    def wait_for(self, holds: Callable[[], bool], what: str) -> None:
        end_s = time.monotonic() + _PATIENCE_S
        while not holds():
            assert time.monotonic() < end_s, f"{what}; {self.errors}"
            time.sleep(0.05)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """kind: mousePressed, mouseMoved or mouseReleased."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1,
                  clickCount=1)  # fmt: skip


@contextlib.contextmanager
def driven_browser(folder: Path) -> Iterator[DrivenBrowser]:
    """A browser of its own, with its profile in `folder`."""
    reads_from, to = os.pipe()
    back, writes_to = os.pipe()
    # The protocol is spoken over the descriptors 3 and 4.
    shell = f'exec 3<&{reads_from} 4>&{writes_to}; exec "$0" "$@"'
    command = ["bash", "-c", shell, CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu",
               "--hide-scrollbars", f"--user-data-dir={folder / 'driven'}",
               "--remote-debugging-pipe"]  # fmt: skip
    process = subprocess.Popen(command, pass_fds=(reads_from, writes_to),
                               stderr=subprocess.DEVNULL)  # fmt: skip
    os.close(reads_from)
    os.close(writes_to)
    try:
        yield DrivenBrowser(to, back)
    finally:
        process.kill()
        process.wait()
        os.close(to)
        os.close(back)
