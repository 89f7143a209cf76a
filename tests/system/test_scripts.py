"""Scripts start with --help; lines of the pages for a shell alone: of root, of pip, loops."""

import shlex
import shutil
import subprocess
import sys
import tomllib

import pytest
from support.pages.documents import PAGES, Block, blocks
from support.paths import ROOT

# Started by a process of ours with a descriptor of its own; its tests do that.
INTERNAL = {"host/devices/can_bridge.py", "tests/support/in_process.py"}
MAKERS = {"tests/support/c/golden_forces.py", "tests/support/c/golden_scenes.py",
          "tests/support/pages/notebooks.py"}  # fmt: skip

SHELL = [block for page in PAGES for block in blocks(page) if block.language == "sh"]
PACKAGES = [block for block in SHELL if block.text.startswith("sudo apt-get install ")]


def scripts() -> list[str]:
    listed = subprocess.run(
        ["git", "grep", "-lE", "^if __name__ == .__main__.:", "--", "*.py"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return [name for name in listed.stdout.split() if name not in INTERNAL]


@pytest.mark.slow
@pytest.mark.parametrize("script", scripts())
def test_a_script_starts(script: str) -> None:
    """The makers as modules of tests/, the others from the repository's folder."""
    command, folder = [script], ROOT
    if script in MAKERS:
        command = ["-m", script.removeprefix("tests/").removesuffix(".py").replace("/", ".")]
        folder = ROOT / "tests"
    done = subprocess.run(
        [sys.executable, *command, "--help"],
        cwd=folder, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip
    assert (done.returncode, done.stdout[:6]) == (0, "usage:"), done.stderr[-500:]


def known_packages() -> bool:
    """Tell whether this system has lists of Debian's packages."""
    command = ["apt-cache", "show", "gcc"]
    return (
        bool(shutil.which("apt-cache"))
        and not subprocess.run(command, capture_output=True, check=False).returncode
    )


def test_each_shell_block_is_run_by_a_test() -> None:
    """tests/host/study/test_paper_scenes.py; .ci/packages; below."""
    others = [block for block in SHELL if block not in PACKAGES]
    assert [block.text.split()[0] for block in others] == ["for", "python3"]


@pytest.mark.slow
@pytest.mark.skipif(not known_packages(), reason="no lists of packages: apt-get update")
@pytest.mark.parametrize("block", PACKAGES, ids=lambda block: block.where)
def test_packages_exist(block: Block) -> None:
    for line in block.commands:
        words = shlex.split(line)[1:]  # without sudo: a simulation needs no rights
        done = subprocess.run([*words, "--simulate"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_the_wheel_of_the_page_is_that_of_this_version() -> None:
    (block,) = (block for block in SHELL if block.text.startswith("python3 -m venv"))
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"springpot-{version}-py3-none-any.whl" in block.text
    assert str(block.page.relative_to(ROOT)) in (ROOT / ".ci" / "packages").read_text()
