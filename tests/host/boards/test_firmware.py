"""Firmware is free of warnings, and what its user wrote into its folder is never lost."""

import shutil
import subprocess
from itertools import cycle
from pathlib import Path

import pytest
from support.c.mcu import need, target_scene
from support.small import model_file

from springpot.codegen.errors import UsageError
from springpot.host.emission.boards import (
    BOARDS,
    TRANSDUCER,
    build_batch,
    build_firmware,
    compiler_of,
)
from springpot.host.emission.emission import emit
from springpot.runtime_c.paths import flags

pytestmark = [pytest.mark.board, pytest.mark.slow]

MODES = ["off", "tool", "proxy"]
TRIPLES = {"cortex-m4f": "thumbv7em-none-eabihf", "cortex-m7": "thumbv7em-none-eabihf",
           "rv32imafc": "riscv32-unknown-elf"}  # fmt: skip


@pytest.mark.parametrize(("board", "mode"), list(zip(BOARDS, cycle(MODES), strict=False)))
def test_gcc_and_clang_of_the_target(tmp_path: Path, board: str, mode: str) -> None:
    """Couplings take turns: all boards have one C (test_mcu_budget.py)."""
    need(board)
    clang = shutil.which("clang")
    if clang is None:
        pytest.skip("no clang: `apt-get install clang`")
    target = BOARDS[board].target
    emit(target_scene(target, mode=mode), model_file(tmp_path), tmp_path / "c")
    assert build_firmware(tmp_path / "c", BOARDS[board], tmp_path / "f", strict=True).exists()
    build_batch(tmp_path / "c", BOARDS[board], tmp_path / "f")
    compiler = compiler_of(BOARDS[board])
    report = subprocess.run([*compiler.compiler, *compiler.flags, "-E", "-x", "c", "-M", "-"],
                            input="#include <math.h>\n", capture_output=True, text=True,
                            check=True).stdout  # fmt: skip
    include = next(Path(word).parent for word in report.split() if word.endswith("/math.h"))
    own = [flag for flag in compiler.flags if flag.startswith(("-mcpu", "-march", "-mabi"))]
    sources = sorted((tmp_path / "f").glob("*.c"))
    assert len(sources) > 5
    command = [clang, f"--target={TRIPLES[target]}", *own, *flags("SP_CFLAGS"),
               *flags("SP_STRICT"), "-ffreestanding", "-fsyntax-only", "-isystem", str(include),
               *map(str, sources)]  # fmt: skip
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr[:3000]


BOARD = "mps2-an386"


def test_the_users_files_stand(tmp_path: Path) -> None:
    need(BOARD)
    emit(target_scene("cortex-m4f"), model_file(tmp_path), tmp_path / "c")
    out = tmp_path / "firmware"

    def build() -> bytes:
        return build_firmware(tmp_path / "c", BOARDS[BOARD], out).read_bytes()

    plain = build()
    assert build() == plain
    own = (out / TRANSDUCER).read_text().replace("return 0;", "*position_m = 1e-3f; return 1;")
    (out / TRANSDUCER).write_text(own)
    changed = build()
    assert changed != plain
    assert (out / TRANSDUCER).read_text() == own
    assert build() == changed
    (out / "sp_port.c").write_text("/* mine */\n" + (out / "sp_port.c").read_text())
    with pytest.raises(UsageError, match=r"sp_port.c: not as springpot emitted it: move your"):
        build()
    assert (out / "sp_port.c").read_text().startswith("/* mine */")
