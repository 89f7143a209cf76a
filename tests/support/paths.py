"""Where things lie in a checkout."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
C_TESTS = TESTS / "c"
BENCH = TESTS / "bench"
ZIG = ROOT / "build/zig/ziglang/zig"


def commit() -> str:
    """Name the commit of the checkout, shortened."""
    command = ["git", "rev-parse", "--short", "HEAD"]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=False
    ).stdout.strip()
