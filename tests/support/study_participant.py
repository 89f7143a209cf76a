"""Someone at a participant's screen, over HTTP: feels every slot, then answers."""

import contextlib
import json
import threading
import urllib.request
from typing import Any


class ScriptedParticipant:
    """Works the screen at an address until it is gone; `seen`: every text that was shown."""

    def __init__(self, address: str) -> None:
        self._address = address
        self.seen: list[str] = []
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._thread.start()

    def join(self) -> None:
        """Wait until the screen is gone."""
        self._thread.join(20)

    def _follow(self) -> None:
        try:
            with urllib.request.urlopen(self._address + "events", timeout=20) as stream:
                for line in stream:
                    text = line.decode().rstrip("\n")
                    if text.startswith("event: "):
                        event = text.removeprefix("event: ")
                    elif text.startswith("data: ") and event != "position":
                        self.seen.append(text)
                        if event == "state":
                            self._do(json.loads(text.removeprefix("data: ")))
        except (OSError, ValueError):
            pass  # the session is over

    def _do(self, state: dict[str, Any]) -> None:
        if state["answered"] or state["wanted"] is not None:
            return
        if not state["slots"] and state["ask"] is None:
            if "Space" in state["instruction"]:
                self._act(state, "next", 0)
        elif state["active"] is not None and state["active"] + 1 < len(state["slots"]):
            threading.Timer(0.15, self._act, (state, "slot", state["active"] + 1)).start()
        elif state["slots"] and state["active"] is None:
            self._act(state, "slot", 0)
        else:  # the last slot, or a question
            threading.Timer(0.15, self._give, (state,)).start()

    def _give(self, state: dict[str, Any]) -> None:
        ask = state["ask"]
        self._act(state, "answer", ask["choices"][0] if ask["choices"] else "50")

    def _act(self, state: dict[str, Any], kind: str, value: Any) -> None:
        body = json.dumps({"state": state["number"], "kind": kind, "value": value}).encode()
        with (
            contextlib.suppress(OSError),
            urllib.request.urlopen(self._address + "act", body, timeout=10) as answer,
        ):
            answer.read()
