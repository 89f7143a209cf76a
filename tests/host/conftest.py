"""A folder that commands are run on, of several modules."""

from pathlib import Path

import pytest
from support.small import model_file, press, recording, scene, training

from springpot.host.emission.emission import emit
from springpot.host.files import write_recordings
from springpot.trainer.recordings.hdf5_file import write_recording


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings in rec and press.h5, a passive model, a scene, and its C in c."""
    folder = tmp_path_factory.mktemp("job")
    write_recordings(folder / "rec", training())
    write_recording(folder / "press.h5", recording("press", press(2.0)))
    (folder / "scene.toml").write_text('schema = 1\nname = "test"\nmodel = "model.spm"\n')
    emit(scene(), model_file(folder), folder / "c")
    return folder
