"""Until the report nobody reads what is what: no text holds a scene's or an object's name."""

import json
from pathlib import Path

import h5py
from click.testing import CliRunner
from support.small_study import SOFT, planned, real_stimulus, scene_stimulus, study_text

from springpot.host.cli import springpot
from springpot.host.wings.study.folder import DEFINITION, KEY
from springpot.host.wings.study.outline import outline

# What holds names by its nature, and is not looked at by who runs the study: the definition, the
# key, the frozen scenes. `plan` prints what to have at hand, once, for who puts stickers on it.
OPENED = (DEFINITION, KEY, "scenes")
NAMES = ("Quince", "Medlar", "Sorb", SOFT)


def texts_of(folder: Path) -> dict[str, str]:
    """All names of files and all text in them, of recordings too."""
    found = {}
    for file in sorted(folder.rglob("*")):
        relative = file.relative_to(folder)
        if relative.parts[0] in OPENED or file.is_dir():
            continue
        content = file.read_bytes().decode("utf-8", errors="replace")
        if file.suffix == ".h5":
            with h5py.File(file) as recording:
                values = dict(recording.attrs)
                recording.visititems(lambda name, item, values=values: values.update(
                    {name: dict(item.attrs)}))  # fmt: skip
                content += repr(values)
        found[str(relative)] = content
    return found


def test_no_name_before_the_report(tmp_path: Path) -> None:
    stimuli = [scene_stimulus("Quince"), scene_stimulus("Medlar", stiffer=1.3),
               real_stimulus("Sorb")]  # fmt: skip
    pairs = [{"left": "Sorb", "right": "Quince"}, {"left": "Quince", "right": "Medlar"}]
    study = planned(tmp_path, study_text("similarity", stimuli, pairs), 2, SOFT)
    command = ["study", "simulate", str(study.path), "--observers", "2", "--out",
               str(tmp_path / "sim")]  # fmt: skip
    result = CliRunner().invoke(springpot, command, catch_exceptions=False)
    texts = {"printed": result.output, **texts_of(tmp_path / "sim")}
    assert any(name.endswith("trial-001.h5") for name in texts)
    assert any(name.endswith("trials.jsonl") for name in texts)
    for where, text in texts.items():
        for name in NAMES:
            assert name.lower() not in (where + text).lower(), f"{where} holds {name}"


def test_the_plan_says_what_could_be_blind(tmp_path: Path) -> None:
    stimuli = [scene_stimulus("a"), scene_stimulus("b", stiffer=1.3), real_stimulus("c")]
    pairs = [{"left": "a", "right": "b"}, {"left": "a", "right": "c"}]
    study = planned(tmp_path, study_text("similarity", stimuli, pairs), 3, SOFT)
    found = outline(study)
    assert (found["conditions"], found["blind"]) == (2, 1)
    assert found["stickers"] == {"R1": "c on the tray"}
    assert json.dumps(found)
