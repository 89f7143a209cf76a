"""What a release says of itself, and that what it requires is enough: rendering loads no extra."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from support.pages.job import small_job
from support.paths import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
VERSION = PROJECT["version"]


def tracked(*patterns: str) -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", *patterns], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split()
    return [ROOT / name for name in listed]


def test_the_version_is_said_where_a_release_says_it_and_nowhere_else() -> None:
    assert f"\nversion: {VERSION}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.search(rf"^## {re.escape(VERSION)}\b", (ROOT / "CHANGELOG.md").read_text(), re.M)
    homes = [file for file in tracked("*.py") if f'"{VERSION}"' in file.read_text()]
    assert not homes


def test_everything_locked_has_a_hash_and_everything_needed_is_locked() -> None:
    lock = (ROOT / "requirements.lock").read_text()
    pins = re.findall(r"^([\w.-]+)==\S+.*?\n((?:    --hash=sha256:[0-9a-f]{64}.*\n)+)", lock, re.M)
    locked = {name.lower() for name, _ in pins}
    assert len(pins) == len(re.findall(r"^\S+==", lock, re.M))
    extras = PROJECT["optional-dependencies"]
    needed = [*PROJECT["dependencies"], *(item for name in extras for item in extras[name])]
    names = {re.split(r"[\[>=]", item)[0].lower() for item in needed}
    assert names - locked == {"springpot", "ziglang"}  # ziglang: where there is no compiler at all


EXTRAS = ("scipy", "sklearn", "joblib", "matplotlib", "can", "m2cgen", "statsmodels")
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
