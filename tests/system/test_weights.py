"""What is required is enough: rendering, and what checks it, loads none of the extras' packages."""

import subprocess
import sys
from pathlib import Path

import pytest
from support.job import small_job

EXTRAS = ("scipy", "sklearn", "joblib", "matplotlib", "jinja2", "can", "cantools", "m2cgen")
CODE = (
    "import sys\nfor name in {!r}: sys.modules[name] = None\n"
    "sys.argv = ['springpot', *{!r}]\nfrom springpot.host.cli import main\nmain()"
)
COMMANDS = (
    "check training",
    "emit --scene scene.toml --out c",
    "validate c --recording validation",
    "stability --scene scene.toml",
    "run --scene scene.toml --device sim://ecoflex-00-30 --seconds 0.5 --log felt.h5",
    "validate c --recording felt.h5",
)


@pytest.mark.slow
def test_what_is_required_renders(tmp_path: Path) -> None:
    small_job(tmp_path)
    for line in COMMANDS:
        absent = EXTRAS if "--device" in line else (*EXTRAS, "serial")
        done = subprocess.run(
            [sys.executable, "-c", CODE.format(absent, line.split())],
            cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{line}\n{done.stderr}"


def test_what_trains_says_which_extra_it_needs(tmp_path: Path) -> None:
    small_job(tmp_path)
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
