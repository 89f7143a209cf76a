"""Generated C, ports and protocol are free of warnings for every compiler and target."""

import shutil
import subprocess
from pathlib import Path

import pytest
from support.mcu import need, target_scene
from support.small import model_file

from springpot.host.boards.boards import BOARDS, compiler_of
from springpot.host.boards.firmware import build_batch, build_firmware
from springpot.host.emission.emission import emit
from springpot.runtime_c.paths import flags

pytestmark = [pytest.mark.board, pytest.mark.slow]

MODES = ["off", "tool", "proxy"]
TRIPLES = {"cortex-m4f": "thumbv7em-none-eabihf", "cortex-m7": "thumbv7em-none-eabihf",
           "rv32imafc": "riscv32-unknown-elf"}  # fmt: skip


@pytest.mark.parametrize("mode", MODES)
def test_gcc_of_the_target(tmp_path: Path, mode: str) -> None:
    """All boards have one C (test_mcu_budget.py)."""
    need(*BOARDS)
    emit(target_scene("cortex-m4f", mode=mode), model_file(tmp_path), tmp_path / "c")
    for name, board in BOARDS.items():
        assert build_firmware(tmp_path / "c", board, tmp_path / name, strict=True).exists()


@pytest.mark.parametrize("board", list(BOARDS))
def test_clang_of_the_target(tmp_path: Path, board: str) -> None:
    need(board)
    clang = shutil.which("clang")
    if clang is None:
        pytest.skip("no clang: `apt-get install clang`")
    target = BOARDS[board].target
    emit(target_scene(target), model_file(tmp_path), tmp_path / "c")
    build_firmware(tmp_path / "c", BOARDS[board], tmp_path / "f")
    build_batch(tmp_path / "c", BOARDS[board], tmp_path / "f")
    compiler = compiler_of(BOARDS[board])
    report = subprocess.run([*compiler.compiler, *compiler.flags, "-E", "-x", "c", "-M", "-"],
                            input="#include <math.h>\n", capture_output=True, text=True,
                            check=True).stdout  # fmt: skip
    include = next(Path(word).parent for word in report.split() if word.endswith("/math.h"))
    own = [flag for flag in compiler.flags if flag.startswith(("-mcpu", "-march", "-mabi"))]
    sources = sorted((tmp_path / "f").glob("*.c"))
    assert len(sources) > 6
    command = [clang, f"--target={TRIPLES[target]}", *own, *flags("SP_CFLAGS"),
               *flags("SP_STRICT"), "-ffreestanding", "-fsyntax-only", "-isystem", str(include),
               *map(str, sources)]  # fmt: skip
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr[:3000]
