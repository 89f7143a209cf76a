"""Pages with real time and a real pointer: a session, a board on a cable, frames a second."""

import base64
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.browser import NEEDS_PAGES
from support.driven_browser import DrivenBrowser, driven_browser
from support.small import model_file, scene, small_model

from springpot.host.devices.wire import Receiver, Sender, constant, layout
from springpot.host.emission.emission import emit
from springpot.host.page.press_page import write_press_page

pytestmark = [pytest.mark.realtime, *NEEDS_PAGES]

# A board of the browser's own: what it would send is given, what is written to it is kept.
_FAKE_PORT = """
window.told = [];
Object.defineProperty(navigator, "serial", { value: { requestPort: async () => ({
  open: async (options) => { window.baud = options.baudRate; },
  readable: { getReader: () => ({ read: () => new Promise((done) => { window.send = (text) =>
    done({ value: Uint8Array.from(atob(text), (x) => x.charCodeAt(0)), done: false }); }) }) },
  writable: { getWriter: () => ({ write: async (bytes) => { window.told.push(...bytes); } }) },
}) } });
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    emit(scene(), model_file(tmp_path, small_model()), tmp_path / "c")
    return tmp_path / "c"


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[DrivenBrowser]:
    with driven_browser(tmp_path) as found:
        yield found


def hash_of(browser: DrivenBrowser) -> str:
    return str(browser.value("JSON.parse(document.getElementById('scenes').textContent)[0].hash"))


def number_of(browser: DrivenBrowser, name: str) -> float:
    return float(browser.text(name).split()[0])


def test_a_real_pointer_presses_and_lets_go(
    tmp_path: Path, folder: Path, browser: DrivenBrowser
) -> None:
    write_press_page([folder], tmp_path / "press.html")
    browser.open_ready((tmp_path / "press.html").as_uri())
    left, y, width, height = browser.box("object")
    x = left + width / 2
    browser.mouse("mousePressed", x, y + 0.32 * height)
    browser.mouse("mouseMoved", x, y + 0.7 * height)
    browser.wait_for(lambda: number_of(browser, "force") > 1.0, "a force")
    assert number_of(browser, "depth") > 2.0
    browser.mouse("mouseReleased", x, y + 0.7 * height)
    browser.wait_for(lambda: number_of(browser, "depth") < 0.0, "the hand has left")
    assert number_of(browser, "force") == 0.0
    assert browser.errors == []


def test_a_session_is_shown_and_stopped(folder: Path, browser: DrivenBrowser) -> None:
    main = "from springpot.host.cli import main; main()"
    command = [sys.executable, "-c", main, "run", "--scene", str(folder), "--device",
               "sim://ecoflex-00-30", "--seconds", "60", "--page", "--json"]  # fmt: skip
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        address = next(line for line in run.stderr if "page: " in line).split("page: ")[1].strip()
        browser.open_ready(address)
        browser.until("Number(document.body.dataset.ticks) > 1000")
        browser.key("keyDown", "q")
        result = json.loads(run.stdout.read())
        assert run.wait() == 0
        assert result["stopped"] == "stopped by the user"
        assert result["hash"] == hash_of(browser)
        assert result["ring_dropped"] == 0
    browser.until("document.getElementById('said').textContent.startsWith('The session has ended')")
    assert browser.errors == []


def test_a_board_is_shown_and_told_to_stop(
    tmp_path: Path, folder: Path, browser: DrivenBrowser
) -> None:
    write_press_page([folder], tmp_path / "press.html")
    browser.call("Page.addScriptToEvaluateOnNewDocument", source=_FAKE_PORT)
    browser.open_ready((tmp_path / "press.html").as_uri())
    browser.value("document.getElementById('connect').click()")
    browser.until("window.send !== undefined")
    sender, positions_m = Sender(), np.linspace(0.0, 0.004, 200)
    scene_hash = bytes.fromhex(hash_of(browser))
    said = sender.encode("hello", layout=layout(), role=constant("RENDERS"), rate_hz=1000.0,
                         max_n=12.0, model=scene_hash)  # fmt: skip
    for position_m in positions_m:
        said += sender.encode("rendered", call=0, position_m=position_m, velocity_mps=0.0,
                              dt_s=1e-3, force_n=100.0 * position_m, notes=4)  # fmt: skip
    browser.value(f"window.send('{base64.b64encode(said).decode()}')")
    browser.until("document.body.dataset.ticks === '200'")
    browser.until("document.getElementById('said').textContent !== ''")
    assert browser.text("said") == "The board renders this scene; the page shows it."
    assert browser.text("force") == "0.40 N"
    assert browser.value("document.getElementById('stiffness').closest('section').hidden")
    browser.value("window.told.length = 0")
    browser.key("keyDown", "q")
    browser.until("window.told.length > 100")
    told = list(Receiver().feed(bytes(browser.value("window.told"))))
    commands = [frame.values["action"] for frame in told if frame.name == "command"]
    assert commands == [constant("STOP")] * 3
    assert all(frame.values["layout"] == layout() for frame in told if frame.name == "ask")
    assert browser.errors == []
