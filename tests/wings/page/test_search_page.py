"""Find the lump on the page: by mouse, finger and keys, with the colours off and on."""

import math
import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from codegen.stages.test_placed import placed
from support.browser import NEEDS_PAGES
from support.driven_browser import DrivenBrowser, driven_browser
from support.small import model_file, scene

from springpot.host.emission.emission import emit
from springpot.host.wings.page.press_page import write_press_page

pytestmark = [pytest.mark.realtime, *NEEDS_PAGES]
FIRST_MM, LAST_MM = (0.0, -10.0), (20.0, 10.0)  # of the map of `placed`
# Colours of the canvas at a grid of points within the map, apart from the tool in its middle.
_PIXELS = """(() => { const canvas = document.getElementById("map"), found = new Set();
  const { width, height } = canvas, copy = new OffscreenCanvas(width, height);
  const context = copy.getContext("2d", { willReadFrequently: true });
  context.drawImage(canvas, 0, 0);
  for (const x of [0.3, 0.4, 0.65, 0.8]) for (const y of [0.3, 0.45, 0.6, 0.7])
    found.add(context.getImageData(x * width, y * height, 1, 1).data.join());
  return found.size; })()"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("map")
    emit(scene(), model_file(where, placed("plain", 2)), where / "c", accept_unsafe=True)
    write_press_page([where / "c"], where / "press.html")
    return where / "press.html"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DrivenBrowser]:
    with driven_browser(tmp_path_factory.mktemp("browser")) as found:
        yield found


def opened(browser: DrivenBrowser, page: Path, chance: float, width: int = 1600) -> None:
    """chance: what the page's dice say; below a half the map lies mirrored while one searches."""
    browser.call("Page.addScriptToEvaluateOnNewDocument", source=f"Math.random = () => {chance};")
    browser.open_ready(page.as_uri(), width)
    browser.until("Number(document.body.dataset.frames) > 1")


def point(browser: DrivenBrowser, across: float, down: float) -> tuple[float, float]:
    left, top, width, height = browser.box("map")
    return left + across * width, top + down * height


def until_pressed(browser: DrivenBrowser, deep: bool) -> None:
    browser.wait_for(lambda: ("deep" in browser.text("place")) == deep, f"pressed: {deep}")


def shown_mm(browser: DrivenBrowser) -> tuple[float, float]:
    x, y = re.findall(r"[xy] (-?[\d.]+) mm", browser.text("place"))
    return float(x), float(y)


@pytest.mark.parametrize("chance", [0.1, 0.9])
def test_keys_find_the_lump_and_the_page_says_how_far_off(
    page: Path, browser: DrivenBrowser, chance: float
) -> None:
    opened(browser, page, chance)
    assert browser.value(_PIXELS) > 8
    browser.value("document.getElementById('search').click()")
    browser.wait_for(lambda: browser.value(_PIXELS) == 1, "no colours")
    browser.value("document.getElementById('map').focus()")
    browser.press("m")
    assert browser.text("found").startswith("Press somewhere first")
    browser.press(*["ArrowRight"] * 7, *["ArrowUp"] * 3, "Enter")
    until_pressed(browser, True)
    shown = shown_mm(browser)
    assert shown[0] > 10.0 and shown[1] > 0.0
    browser.press(" ")
    until_pressed(browser, False)
    browser.press("m")
    off_mm = float(browser.text("found").split(" mm from")[0])
    at = [
        first + last - its if chance < 0.5 else its
        for its, first, last in zip(shown, FIRST_MM, LAST_MM, strict=True)
    ]
    x, y = map(float, browser.value("document.getElementById('map').dataset.stiffest").split(","))
    assert off_mm == pytest.approx(math.dist(at, (1e3 * x, 1e3 * y)), abs=0.15)
    browser.wait_for(lambda: browser.value(_PIXELS) > 8, "the colours are back")
    assert browser.errors == []


_CHANCE = "{ let s = 7; Math.random = () => (s = (s * 16807) % 2147483647) / 2147483647; }"
_SAVED = """(() => { let saved; const kept = URL.createObjectURL;
  URL.createObjectURL = (blob) => (saved = blob, kept(blob));
  document.getElementById("save-trials").click();
  return saved.text(); })()"""


def test_who_presses_at_nine_places_and_marks_the_stiffest_finds_it_in_trials(
    page: Path, browser: DrivenBrowser
) -> None:
    """Each trial shows another part of the map, mirrored by chance, and says nothing of it."""
    opened(browser, page, 0.9)
    browser.value(_CHANCE)
    browser.value("document.getElementById('trials').click()")

    def pressed_npmm(across: float, down: float) -> float:
        x, y = point(browser, across, down)
        browser.mouse("mouseMoved", x, y)
        browser.mouse("mousePressed", x, y)
        time.sleep(0.9)
        depth_mm, force_n = re.findall(r"(-?[\d.]+) (?:mm deep|N)", browser.text("place"))[:2]
        assert " mm, y" not in browser.text("place")
        browser.mouse("mouseReleased", x, y)
        until_pressed(browser, False)
        return float(force_n) / float(depth_mm)

    for trial in (1, 2):
        assert browser.text("found").startswith(f"Trial {trial} of 10")
        places = [(x, y) for x in (0.3, 0.5, 0.7) for y in (0.3, 0.5, 0.7)]
        stiffest = max(places, key=lambda at: pressed_npmm(*at))
        pressed_npmm(*stiffest)
        browser.value("document.getElementById('mark').click()")
    browser.value("document.getElementById('search').click()")
    assert browser.text("found").startswith("2 of 2 found")
    rows = browser.value(_SAVED).splitlines()
    assert len(rows) == 3 and rows[0].startswith("trial,marked_x_m")
    assert [row.split(",")[-1] for row in rows[1:]] == ["10", "10"]  # presses
    assert browser.errors == []


def test_a_finger_presses_where_it_is_put(page: Path, browser: DrivenBrowser) -> None:
    opened(browser, page, 0.9, width=400)
    x, y = point(browser, 0.75, 0.35)
    browser.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
    until_pressed(browser, True)
    there = shown_mm(browser)
    assert there[0] > 13.0 and there[1] > 2.0
    other = [{"x": x - 100, "y": y + 50}]
    browser.call("Input.dispatchTouchEvent", type="touchMove", touchPoints=other)
    time.sleep(0.3)
    assert shown_mm(browser) == there  # held
    browser.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    until_pressed(browser, False)
    browser.wait_for(lambda: shown_mm(browser) != there, "the tool goes on")
    assert browser.errors == []


def test_the_pointer_chooses_and_the_wheel_presses(page: Path, browser: DrivenBrowser) -> None:
    opened(browser, page, 0.9)
    x, y = point(browser, 0.3, 0.7)
    browser.mouse("mouseMoved", x, y)
    browser.wait_for(lambda: shown_mm(browser)[0] < 8.0, "the tool follows")
    assert "deep" not in browser.text("place")

    def turn(ticks: int) -> None:
        for _ in range(abs(ticks)):
            browser.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0,
                         deltaY=math.copysign(100, ticks))  # fmt: skip

    turn(6)
    until_pressed(browser, True)
    turn(-8)
    until_pressed(browser, False)
    assert browser.errors == []
