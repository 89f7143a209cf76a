"""Every script of the repository starts: as its page or its head says, with --help."""

import subprocess
import sys

import pytest
from support.paths import ROOT

# Started by a process of ours with a descriptor of its own; its tests do that.
INTERNAL = {"host/devices/can_bridge.py", "tests/support/in_process.py"}
MAKERS = {"tests/support/c/golden_forces.py", "tests/support/c/golden_scenes.py",
          "tests/support/pages/notebooks.py"}  # fmt: skip


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
