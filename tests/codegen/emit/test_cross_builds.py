"""The emitted C of three scenes on Windows, macOS and Linux: no warning, the same bits."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.paths import ROOT
from support.small import scene

from springpot.host.emission.emission import emit
from springpot.runtime_c.paths import flags

pytestmark = [pytest.mark.board, pytest.mark.slow, pytest.mark.long]  # zig makes C libraries first

KINDS = ("rf-fd", "rbf-pv", "hammerstein")
RUN_BY = {  # None: built, not run
    "x86_64-windows-gnu": "/usr/lib/wine/wine64",
    "aarch64-windows-gnu": None,
    "x86_64-macos": None,
    "aarch64-macos": None,
    "x86_64-linux-musl": "env",
    "aarch64-linux-musl": "qemu-aarch64",
}


@pytest.mark.parametrize("target", RUN_BY)
def test_every_system_gives_the_same_bits(tmp_path: Path, target: str) -> None:
    run_by = RUN_BY[target]
    if importlib.util.find_spec("ziglang") is None:
        pytest.skip("no ziglang: pip install ziglang")
    if run_by and not shutil.which(run_by):
        pytest.skip(f"no {run_by}: apt-get install wine64 qemu-user")
    for kind in KINDS:
        out = tmp_path / kind
        emit(scene(mode="proxy"), ROOT / f"tests/golden/forces/{kind}.spm", out, accept_unsafe=True)
        zig = [sys.executable, "-m", "ziglang", "cc", "-target", target]
        words = [*flags("SP_CFLAGS"), *flags("SP_STRICT"), "-o", out / "test.exe"]
        subprocess.run([*zig, *words, *sorted(out.glob("*.c")), "-lm"], check=True)
        if run_by:  # main.c begins with the self-test
            quiet = {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(tmp_path / "wine")}
            subprocess.run([run_by, out / "test.exe"], input=b"0\n", check=True, env=quiet)
