"""What is required is enough: rendering, and what checks it, loads none of the extras' packages."""

import subprocess
import sys
from pathlib import Path

import pytest
from support.small import model_file, press, recording, training

from springpot.trainer.recordings.recording_file import write_recording

EXTRAS = ("scipy", "sklearn", "joblib", "matplotlib", "jinja2", "can", "cantools", "m2cgen")
CODE = (
    "import sys\nfor name in {!r}: sys.modules[name] = None\n"
    "sys.argv = ['springpot', *{!r}]\nfrom springpot.host.cli import main\nmain()"
)
COMMANDS = (
    "check training",
    "emit --scene scene.toml --out c",
    "validate c --recording held",
    "stability --scene scene.toml",
    "run --scene scene.toml --device sim://ecoflex-00-30 --seconds 0.5 --log felt.h5",
    "validate c --recording felt.h5",
)


@pytest.mark.slow
def test_what_is_required_renders(tmp_path: Path) -> None:
    for name, items in (("training", training()), ("held", [recording("v", press(0.9))])):
        (tmp_path / name).mkdir()
        for item in items:
            write_recording(tmp_path / name / f"{item.name}.h5", item)
    model_file(tmp_path)
    (tmp_path / "scene.toml").write_text('schema = 1\nname = "x"\nmodel = "model.spm"\n')
    for line in COMMANDS:
        absent = EXTRAS if "--device" in line else (*EXTRAS, "serial")
        done = subprocess.run(
            [sys.executable, "-c", CODE.format(absent, line.split())],
            cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{line}\n{done.stderr}"


def test_what_trains_says_which_extra_it_needs(tmp_path: Path) -> None:
    (tmp_path / "training").mkdir()
    for item in training():
        write_recording(tmp_path / "training" / f"{item.name}.h5", item)
    done = subprocess.run(
        [sys.executable, "-c", CODE.format(EXTRAS, ["train", "training", "--model", "rf-fd",
                                                    "--out", "m.spm"])],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    line = done.stderr.splitlines()[-1]
    assert line.endswith("is not installed: `pip install 'springpot[train,report,can,m2cgen]'`"), (
        line
    )
