"""Pictures of the pages of docs/ while they are pressed, by press_pages.py."""

import time
from pathlib import Path

import numpy as np
from PIL import Image

from support.driven_browser import DrivenBrowser, driven_browser
from support.paths import ROOT

_PRESS_S, _PRESSED_S = 1.8, 5.4
_WIDTH, _COLOURS = 900, 64
_SLIDE = np.array([[0.3, 0.62], [0.72, 0.47]])  # from, to: shares of the map's picture
_SLIDE_S = 1.5


def draw_press(place: Path) -> None:
    """docs/press.gif: three presses, each picture shown for as long as it took."""
    frames: list[tuple[float, Image.Image]] = []
    with driven_browser(place) as browser:
        left, top, width, height = opened(browser, "press.html").box("object")
        x, began_s = left + width / 2, time.monotonic()
        browser.mouse("mousePressed", x, top + 0.3 * height)
        # By the page's own clock: a screenshot holds everything else up.
        browser.value(
            f"(() => {{ const began = performance.now(); setInterval(() => {{ const y = {top} + "
            f"{height} * (0.3 + 0.6 * Math.sin(Math.PI * (performance.now() - began) / "
            f"{1e3 * _PRESS_S}) ** 2); document.getElementById('object').dispatchEvent(new "
            f"PointerEvent('pointermove', {{clientX: {x}, clientY: y, pointerId: 1, buttons: 1, "
            f"bubbles: true}})) }}, 5) }})()"
        )
        while (passed_s := time.monotonic() - began_s) < _PRESSED_S:
            browser.screenshot(place / "frame.png")
            with Image.open(place / "frame.png") as shown:
                size = (_WIDTH, round(_WIDTH * shown.height / shown.width))
                frames.append((passed_s, shown.convert("RGB").resize(size)))
    starts_s, pictures = zip(*frames, strict=True)
    palette = pictures[-1].quantize(_COLOURS)
    reduced = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures]
    lasts_ms = [round(1e3 * each) for each in np.diff([*starts_s, _PRESSED_S])]
    reduced[0].save(ROOT / "docs" / "press.gif", save_all=True, append_images=reduced[1:],
                    duration=lasts_ms, loop=0, optimize=True)  # fmt: skip


def draw_slide(place: Path) -> None:
    """docs/press-lump.png: the second object of its page at the end of a slide."""
    with driven_browser(place) as browser:
        opened(browser, "press-lump.html")
        browser.value(
            "(() => { const picker = document.getElementById('picker'); picker.value = 1;"
            " picker.dispatchEvent(new Event('change')); })()"
        )
        browser.until("document.getElementById('slides').hidden === false")
        left, top, width, height = browser.box("map")
        ways = left + width * _SLIDE[:, 0], top + height * _SLIDE[:, 1]
        browser.mouse("mousePressed", *(float(way[0]) for way in ways))
        time.sleep(1.0)
        for share in np.linspace(0.0, 1.0, 50):
            browser.mouse("mouseMoved", *(float(np.interp(share, [0, 1], way)) for way in ways))
            time.sleep(_SLIDE_S / 50)
        browser.screenshot(place / "slide.png")
        beside, _, its_width, _ = browser.box("object")
    with Image.open(place / "slide.png") as shown:
        corners = (left - 8, top - 8, beside + its_width + 8, top + height)
        drawn = shown.convert("RGB").crop(tuple(map(round, corners)))
        drawn.quantize(2 * _COLOURS).save(ROOT / "docs" / "press-lump.png", optimize=True)


def opened(browser: DrivenBrowser, page: str) -> DrivenBrowser:
    browser.open_ready((ROOT / "docs" / page).as_uri(), 1200, 700)
    return browser
