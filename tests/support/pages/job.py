"""Recordings in two folders, a model and a scene: what commands and pages take for given."""

from pathlib import Path

from springpot.trainer.recordings.hdf5_file import write_recording
from support.small import model_file, press, recording, small_model, training

SCENE = 'schema = 1\nname = "x"\nmodel = "model.spm"\n'


def small_job(folder: Path) -> None:
    """Write `training`, `validation`, `press.h5`, `model.spm` and `scene.toml` into a folder."""
    for name, items in (("training", training()), ("validation", [recording("v", press(0.9))])):
        (folder / name).mkdir()
        for item in items:
            write_recording(folder / name / f"{item.name}.h5", item)
    write_recording(folder / "press.h5", recording("press", press(2.0, cycles=2)))
    model_file(folder, small_model())
    (folder / "scene.toml").write_text(SCENE)
