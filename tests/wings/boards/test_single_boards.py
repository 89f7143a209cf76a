"""Scenes in one file on emulated boards: every kind, built as an Arduino or PlatformIO would."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from support.c.mcu import need
from support.c.single import every_plan, write_single

from springpot.codegen.plan.units import state_bytes
from springpot.host.wings.boards import emulator
from springpot.host.wings.boards.boards import BOARDS, Board, compiler_of
from springpot.runtime_c.paths import PORT_MCU, flags

pytestmark = [pytest.mark.board, pytest.mark.slow]

LANGUAGES = {
    "c": ("gcc", ".c", ("-std=gnu11", "-Os")),
    "cpp": ("g++", ".cpp", ("-std=gnu++17", "-O2", "-fno-exceptions", "-fno-rtti")),
}
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
FUSED = re.compile(r"\s(vfn?m[as]|fn?madd|fn?msub)\.")  # of ARM, of RISC-V


def fused(board: Board, built: Path) -> int:
    """Fused multiply-adds of an object."""
    dump = compiler_of(board).compiler[0].removesuffix("gcc") + "objdump"
    said = subprocess.run([dump, "-d", built], capture_output=True, text=True, check=True).stdout
    return len(FUSED.findall(said))


def build(board: Board, source: Path, language: str, out: Path) -> Path:
    compiler, suffix, options = LANGUAGES[language]
    tools = compiler_of(board)
    command = [tools.compiler[0].removesuffix("gcc") + compiler, *tools.flags, *options,
               *WARNINGS, "-ffunction-sections", "-fdata-sections", f"-I{source.parent}", "-c",
               str(source.with_suffix(suffix)), "-o", str(out)]  # fmt: skip
    subprocess.run(command, check=True)
    return out


def link(board: Board, prefixes: list[str], folder: Path, place: Path, stack_bytes: int) -> Path:
    """One program of all scenes; it writes their self-tests' results into returns.bin."""
    includes = "".join(f'#include "{prefix}.h"\n' for prefix in prefixes)
    calls = ", ".join(f"{prefix}_selftest()" for prefix in prefixes)
    (place / "main.c").write_text(
        f'{includes}#include "sp_semihosting.h"\n\nint main(void);\n\nint main(void)\n{{\n'
        f'    const int found[] = {{{calls}}};\n    static const char out[] = "returns.bin";\n'
        "    sp_semihosting_write(sp_semihosting_open(out, sizeof out - 1,\n"
        "        SP_SEMIHOSTING_WRITE_BINARY), found, sizeof found);\n"
        "    sp_semihosting_exit();\n    return 0;\n}\n"
    )
    tools = compiler_of(board)
    ports = [PORT_MCU / name for name in ("sp_port.c", "sp_transducer.c", *board.sources)]
    command = [
        *tools.compiler, *flags("SP_CFLAGS"), *tools.flags, "-nostartfiles", f"-L{PORT_MCU}",
        f"-I{PORT_MCU}", f"-I{folder}", f"-T{PORT_MCU / board.script}", "-Wl,--gc-sections",
        f"-Wl,--defsym=sp_stack_bytes={8 * (stack_bytes // 8 + 1)}", str(place / "main.c"),
        *map(str, ports), *(str(place / f"{prefix}.o") for prefix in prefixes),
        "-lm", "-lc", "-lgcc", "-o", str(place / "program.elf"),
    ]  # fmt: skip
    subprocess.run(command, check=True)
    return place / "program.elf"


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, int]:
    """Source and bytes of the state of every scene; all boards have one C."""
    folder = tmp_path_factory.mktemp("single")
    return {write_single(plan, folder): state_bytes(plan) for plan in every_plan("cortex-m4f")}


@pytest.mark.parametrize(
    ("name", "language"),
    [("mps2-an386", "c"), ("mps2-an500", "cpp"), ("virt", "c")],
)
def test_every_kind_passes_without_a_flag_of_ours(
    tmp_path: Path, emitted: dict[Path, int], name: str, language: str
) -> None:
    need(name)
    board = BOARDS[name]
    for source in emitted:
        built = build(board, source, language, tmp_path / f"{source.stem}.o")
        assert fused(board, built) == 0, source.stem
    prefixes = [source.stem for source in emitted]
    folder = next(iter(emitted)).parent
    program = link(board, prefixes, folder, tmp_path, 4096 + max(emitted.values()))
    emulator._emulate(board, program, tmp_path)
    found = np.frombuffer((tmp_path / "returns.bin").read_bytes(), dtype="<i4")
    assert dict(zip(prefixes, found.tolist(), strict=True)) == dict.fromkeys(prefixes, 0)
