"""Firmware: an emitted scene and a board's port, built for that board."""

import shutil
import subprocess
from pathlib import Path

from springpot.codegen.emit.header import prefixed
from springpot.codegen.errors import BudgetError
from springpot.codegen.files import folder_written_aside
from springpot.codegen.plan import Plan, state_bytes
from springpot.host.boards.boards import Board, compiler_of
from springpot.host.emission.checksums import is_edited, require_replaceable, write_checksums
from springpot.host.emission.emission import read_emission
from springpot.host.native.compiler import CompilerError
from springpot.host.native.scene_library import port_headers, scene_prefix
from springpot.runtime_c.paths import PORT_MCU, flags

TRANSDUCER = "sp_transducer.c"  # the user's encoder and drive
_COMMON = ("sp_firmware.c", "sp_port.c", TRANSDUCER)
_NAME = "firmware.elf"
_STACK_BYTES = 4096  # of everything else


def build_firmware(folder: Path, board: Board, out: Path, strict: bool = False) -> Path:
    """Build the firmware of an emitted folder into `out`, with all its sources beside it.

    An earlier firmware there is replaced; TRANSDUCER, where its user changed it, is built as it is.
    Raises UsageError without a compiler, or where `out` holds anything else or other changes,
    BudgetError where it does not fit the board.
    """
    require_replaceable(out, yours=[TRANSDUCER])
    plan = read_emission(folder).plan
    with folder_written_aside(out) as aside:
        _copy(folder, aside, plan)
        for name in (*_COMMON, *_headers(), *board.sources):
            _port_file(name, plan, aside)
        write_checksums(aside)
        if is_edited(out, TRANSDUCER):
            shutil.copyfile(out / TRANSDUCER, aside / TRANSDUCER)
        sources = (f"{scene_prefix(folder)}.c", *_COMMON, *board.sources)
        _linked(board, aside, sources, state_bytes(plan), strict)
    return out / _NAME


def build_batch(folder: Path, board: Board, out: Path) -> Path:
    """Build the program that makes calls out of a file, for the emulator (sp_batch.c)."""
    plan = read_emission(folder).plan
    _copy(folder, out, plan)
    for name in ("sp_batch.c", "sp_port.c", "sp_transducer.c", *_headers(), *board.sources):
        _port_file(name, plan, out)
    ports = ("sp_batch.c", "sp_port.c", "sp_transducer.c", *board.sources)
    sources = (f"{scene_prefix(folder)}.c", *ports)
    return _linked(board, out, sources, state_bytes(plan))


def _headers() -> list[str]:
    return [file.name for file in PORT_MCU.glob("*.h")]


def _copy(folder: Path, out: Path, plan: Plan) -> None:
    out.mkdir(parents=True, exist_ok=True)
    for file in [*folder.glob("*.h"), folder / f"{scene_prefix(folder)}.c"]:
        shutil.copyfile(file, out / file.name)
    for name, text in port_headers(folder, plan.real).items():
        (out / name).write_text(text)


def _port_file(name: str, plan: Plan, out: Path) -> None:
    """One file of the port, with the scene's prefix where it speaks of the scene."""
    prefix = plan.scene.runtime.prefix
    text = (PORT_MCU / name).read_text().replace('"sp_scene.h"', f'"{prefix}_scene.h"')
    (out / name).write_text(prefixed(text, prefix))


def _linked(
    board: Board, out: Path, sources: tuple[str, ...], selftest_bytes: int, strict: bool = False
) -> Path:
    tools = compiler_of(board)
    command = [
        *tools.compiler, *flags("SP_CFLAGS"), *(flags("SP_STRICT") if strict else ()), *tools.flags,
        "-nostartfiles", f"-L{PORT_MCU}", f"-T{PORT_MCU / board.script}",
        # the self-test keeps a state of its own on the stack
        f"-Wl,--defsym=sp_stack_bytes={-(-(_STACK_BYTES + selftest_bytes) // 8) * 8}",
        *(str(out / file) for file in sources), "-lm", "-lc", "-lgcc", "-o", str(out / _NAME),
    ]  # fmt: skip
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode == 0:
        return out / _NAME
    if "overflowed by" in result.stderr:
        over = next(line for line in result.stderr.splitlines() if "overflowed by" in line)
        raise BudgetError(
            f"{board.name}: the firmware does not fit ({over.split(': ')[-1]}): give the "
            "scene a [budget] and `springpot emit --fit`"
        )
    raise CompilerError(f"{tools.compiler[0]} refused the firmware: {result.stderr.strip()[:600]}")
