"""The pages of docs/ in which people press what springpot makes.

    python tests/bench/press_pages.py [--train DATA] [--picture]

Emits the models of tests/golden/press and writes docs/press.html, five simulated silicones, one
with a recording to compare; docs/press-recorded.html, models of compressions that others recorded,
which are not in the page; and docs/press-lump.html, a simulated object to search. --train makes the
models anew first; DATA: the folder where their ecoflex_compression lies. --picture: docs/press.gif,
the first page while it is pressed, and docs/press-lump.png, the last one during a slide. Needs
clang and lld, the pictures chromium.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.pages.press_pictures import draw_press, draw_slide
from support.paths import ROOT
from support.presses.places import grid_profiles

from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import read_model, write_model
from springpot.codegen.scene import Coupling, Runtime, Scene, ScenePlaces
from springpot.host.emission.emission import emit
from springpot.host.recording.protocols import Profile, load_protocol
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
LUMP, SLID = "lump", "lump, slid over"
PAGES = {
    "press.html": (*SIMULATED, STIFF),
    "press-recorded.html": RECORDED,
    "press-lump.html": (LUMP, SLID),
}
ABOUT = {
    "press.html": "These objects are five silicone rubbers, simulated, and one that was made "
    "stiffer: add delay, press it hard, and it shakes.",
    "press-recorded.html": "These objects are real: cylinders of three silicone rubbers, 50 mm "
    "wide, compressed slowly by Abubakar Dawood (tissue-phantom-material-database, CC BY 4.0).",
    "press-lump.html": "This object is a simulated soft layer with two lumps, recorded at 49 "
    "places: find the stiffest with the colours off.",
}
# Its presses: those of the paper at five places, two at each of the others; of a tip of 8 mm.
_SIDE = 7
_TIP_MM = 8.0
_REPEATS = 5  # of the ten compressions of a cylinder
_HAND_M = 0.003


def page_scene(name: str) -> Scene:
    """The scene that is emitted for one of the objects."""
    runtime = Runtime(rate_hz=1000.0)  # compressions were sampled at 10 Hz
    # The stiff one without coupling: what delay does to it is to be seen; a slide has none.
    coupling = Coupling(mode="off" if name in (STIFF, LUMP, SLID) else "auto")
    places = ScenePlaces("lateral", _TIP_MM) if name == SLID else ScenePlaces()
    return Scene(
        schema=1,
        name=name,
        model=f"{name}.spm",
        runtime=runtime,
        coupling=coupling,
        places=places,
    )


def page_model(name: str) -> Model:
    """The stored model of an object, or that of the first made stiffer."""
    if name == STIFF:
        return read_model(MODELS / f"{SIMULATED[0]}.spm").stiffened(5.0)
    return read_model(MODELS / f"{LUMP if name == SLID else name}.spm")


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
                compare(folders[0], simulated(names[0], load_protocol("validation", 2), place, 2))
            write_press_page(folders, ROOT / "docs" / page, about=ABOUT[page])
        if asked.picture:
            draw_press(place)
            draw_slide(place)


def train(data: Path, place: Path) -> None:
    """Fit every model."""
    MODELS.mkdir(exist_ok=True)
    for name in SIMULATED:
        save(name, simulated(name, load_protocol("paper", 1), place))
    save(LUMP, simulated(LUMP, grid_profiles(_SIDE), place))
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


def simulated(
    name: str, profiles: Sequence[Profile], place: Path, seed: int = 1
) -> list[Recording]:
    """Recordings of a simulated silicone."""
    url, folder = f"sim://{name}", place / f"{name}-{seed}"
    record_session(open_press_device(url, seed), url, "pages", profiles, folder)
    return read_recordings([folder])


def emitted(name: str, folder: Path) -> Path:
    model_file = folder.with_suffix(".spm")
    write_model(model_file, page_model(name))
    emit(page_scene(name), model_file, folder)
    return folder


def compare(folder: Path, recordings: list[Recording]) -> None:
    """Validate with the first recording: the page shows it."""
    store_validation(folder, validate(folder, recordings[:1], paced_s=0.1))


if __name__ == "__main__":
    main()
