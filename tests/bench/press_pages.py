"""The pages of docs/ in which people press what springpot makes.

    python tests/bench/press_pages.py [--train DATA] [--picture]

Emits the models of tests/golden/press and writes docs/press.html, five simulated silicones, one
with a recording to compare, and docs/press-recorded.html, models of compressions that others
recorded, which are not in the page. --train makes the models anew first; DATA: the folder where
their ecoflex_compression lies. --picture: docs/press.gif, the first page while it is pressed.
Needs clang and lld, the picture chromium.
"""

import argparse
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.driven_browser import driven_browser
from support.paths import ROOT

from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import read_model, write_model
from springpot.codegen.scene import Coupling, Runtime, Scene
from springpot.host.emission.emission import emit
from springpot.host.recording.protocols import load_protocol
from springpot.host.recording.session import open_press_device, record_session
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import validate
from springpot.host.wings.page.press_page import write_press_page
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import read_recordings

MODELS = ROOT / "tests" / "golden" / "press"
SIMULATED = ("ecoflex-00-30", "ecoflex-00-10", "ecoflex-00-50", "dragon-skin-fx", "dragon-skin-10")
RECORDED = ("ecoflex-00-30-cylinder", "ecoflex-00-10-cylinder", "ecoflex-00-50-cylinder")
STIFF = "ecoflex-00-30, five times stiffer"
PAGES = {"press.html": (*SIMULATED, STIFF), "press-recorded.html": RECORDED}
ABOUT = {
    "press.html": "These objects are five silicone rubbers, simulated, and one that was made "
    "stiffer: add delay, press it hard, and it shakes.",
    "press-recorded.html": "These objects are real: cylinders of three silicone rubbers, 50 mm "
    "wide, compressed slowly by Abubakar Dawood (tissue-phantom-material-database, CC BY 4.0).",
}
_REPEATS = 5  # of the ten compressions of a cylinder
_HAND_M = 0.003
_PRESS_S, _PRESSED_S = 1.8, 5.4
_WIDTH, _COLOURS = 900, 64


def page_scene(name: str) -> Scene:
    """The scene that is emitted for one of the objects."""
    runtime = Runtime(rate_hz=1000.0)  # compressions were sampled at 10 Hz
    # The stiff one without coupling: what delay does to it is to be seen.
    coupling = Coupling(mode="off" if name == STIFF else "auto")
    return Scene(schema=1, name=name, model=f"{name}.spm", runtime=runtime, coupling=coupling)


def page_model(name: str) -> Model:
    """The stored model of an object, or that of the first made stiffer."""
    if name == STIFF:
        return read_model(MODELS / f"{SIMULATED[0]}.spm").stiffened(5.0)
    return read_model(MODELS / f"{name}.spm")


def main() -> None:
    """Train what was asked for, then write both pages."""
    parser = argparse.ArgumentParser(description="the pages of docs/")
    parser.add_argument("--train", type=Path, metavar="DATA", help="recordings by others")
    parser.add_argument("--picture", action="store_true", help="draw docs/press.gif, too")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        if asked.train is not None:
            train(asked.train, place)
        for page, names in PAGES.items():
            folders = [emitted(name, place / name) for name in names]
            if page == "press.html":
                compare(folders[0], simulated(names[0], "validation", 2, place))
            write_press_page(folders, ROOT / "docs" / page, about=ABOUT[page])
        if asked.picture:
            draw_picture(place)


def train(data: Path, place: Path) -> None:
    """Fit every model."""
    MODELS.mkdir(exist_ok=True)
    for name in SIMULATED:
        save(name, simulated(name, "paper", 1, place))
    for name in RECORDED:
        sample = f"EF{name.split('-')[2]}_0T"
        files = [data / "ecoflex_compression" / sample / f"{sample}_A{repeat}.csv"
                 for repeat in range(1, _REPEATS + 1)]  # fmt: skip
        save(name, [begun(only) for file in files
                    for only in import_file(file, None, "none", None).recordings])  # fmt: skip


def begun(compression: Recording) -> Recording:
    """What a hand can press of it: a machine goes on to 20 mm and 1180 N."""
    rows = compression.position_m <= _HAND_M
    return replace(
        compression,
        position_m=compression.position_m[rows],
        force_n=compression.force_n[rows],
        channels={},
    )


def save(name: str, recordings: list[Recording] | tuple[Recording, ...]) -> None:
    fit = fit_model("hammerstein", name, tuple(recordings), FitOptions())
    write_model(MODELS / f"{name}.spm", replace(fit.model, provenance={"name": name}))


def simulated(name: str, protocol: str, seed: int, place: Path) -> list[Recording]:
    """Recordings of a simulated silicone."""
    url, folder = f"sim://{name}", place / f"{name}-{protocol}"
    device = open_press_device(url, seed)
    record_session(device, url, protocol, load_protocol(protocol, seed), folder, lambda _: None)
    return read_recordings([folder])


def emitted(name: str, folder: Path) -> Path:
    model_file = folder.with_suffix(".spm")
    write_model(model_file, page_model(name))
    emit(page_scene(name), model_file, folder)
    return folder


def compare(folder: Path, recordings: list[Recording]) -> None:
    """Validate with the first recording: the page shows it."""
    store_validation(folder, validate(folder, recordings[:1], paced_s=0.1))


def draw_picture(place: Path) -> None:
    """Three presses, a picture after the other, each shown for as long as it took."""
    frames: list[tuple[float, Image.Image]] = []
    with driven_browser(place) as browser:
        browser.open((ROOT / "docs" / "press.html").as_uri(), 1200, 700)
        browser.until("document.body !== null && document.body.classList.contains('ready')")
        left, top, width, height = browser.value(
            "(() => { const box = document.getElementById('object').getBoundingClientRect();"
            " return [box.left, box.top, box.width, box.height]; })()"
        )
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


if __name__ == "__main__":
    main()
