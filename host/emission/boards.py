"""Boards that springpot brings a port for, and their firmware: an emitted scene and the port."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import BudgetError, UsageError
from springpot.codegen.files import folder_written_aside
from springpot.codegen.messages import short_repr
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.scene import Target
from springpot.host.emission.checksums import is_edited, require_replaceable, write_checksums
from springpot.host.emission.emission import read_emission
from springpot.host.native.compiler import CompilerError, run_compiler
from springpot.host.native.scene_library import scene_prefix, write_port
from springpot.host.native.toolchain import PROGRAMS, Toolchain, missing_tools, toolchain
from springpot.runtime_c.paths import PORT_MCU, flags

_MPS2 = ("mps2.ld", ("sp_arm.c", "sp_board_mps2.c"), "qemu-system-arm")
TRANSDUCER = "sp_transducer.c"  # the user's encoder and drive
_COMMON = ("sp_firmware.c", "sp_port.c", TRANSDUCER)
_PROGRAM = "firmware.elf"
_STACK_BYTES = 4096  # of everything else


@dataclass(frozen=True)
class Board:
    """target: of the compiler. sources, script: files of runtime_c/port/mcu. emulator: program.

    counter_hz: of the counter that sp_batch.c reads, in the emulated time.
    """

    name: str
    target: Target
    script: str
    sources: tuple[str, ...]
    emulator: str
    options: tuple[str, ...]
    counter_hz: float
    __repr__ = short_repr


BOARDS = {
    board.name: board
    for board in (
        Board("mps2-an386", "cortex-m4f", *_MPS2, (), 25e6),
        Board("mps2-an500", "cortex-m7", *_MPS2, (), 25e6),
        Board(
            "netduinoplus2",
            "cortex-m4f",
            "stm32f405.ld",
            ("sp_arm.c", "sp_board_stm32f405.c"),
            "qemu-system-arm",
            (),
            168e6,
        ),
        Board(
            "virt",
            "rv32imafc",
            "virt.ld",
            ("sp_board_virt.c",),
            "qemu-system-riscv32",
            ("-bios", "none"),
            1e9,
        ),
    )
}


def default_board(target: Target) -> Board | None:
    """The first board of a target; None for a PC."""
    return next((board for board in BOARDS.values() if board.target == target), None)


def board_of(name: str) -> Board:
    """Return the board of a name. Raises UsageError with all names."""
    if name not in BOARDS:
        raise UsageError(f"{name}: no such board: use {', '.join(BOARDS)}")
    return BOARDS[name]


def compiler_of(board: Board) -> Toolchain:
    """Return the board's compiler. Raises UsageError with what to install."""
    tools = toolchain(board.target)
    if tools is None:
        raise UsageError(missing_tools(board.target))
    return tools


def emulator_of(board: Board) -> str:
    """Return the path of the board's emulator. Raises UsageError with what to install."""
    found = shutil.which(board.emulator)
    if found is None:
        package, _ = PROGRAMS[board.emulator]
        raise UsageError(f"no {board.emulator}: `apt-get install {package}`")
    return found


def missing(board: Board) -> str:
    """What is missing to build for the board and to emulate it; nothing where all is there."""
    for find in (compiler_of, emulator_of):
        try:
            find(board)
        except UsageError as error:
            return str(error)
    return ""


def build_firmware(folder: Path, board: Board, out: Path, strict: bool = False) -> Path:
    """Build the firmware of an emitted folder into `out`, with all its sources beside it.

    An earlier firmware there is replaced; TRANSDUCER, where its user changed it, is built as it is.
    Raises UsageError without a compiler, or where `out` holds anything else or other changes,
    BudgetError where it does not fit the board.
    """
    require_replaceable(out, yours=[TRANSDUCER])
    plan = read_emission(folder).plan
    with folder_written_aside(out) as aside:
        sources = _copied(folder, aside, plan, (*_COMMON, *board.sources))
        write_checksums(aside)
        if is_edited(out, TRANSDUCER):
            shutil.copyfile(out / TRANSDUCER, aside / TRANSDUCER)
        _linked(board, aside, sources, state_bytes(plan), strict)
    return out / _PROGRAM


def build_batch(folder: Path, board: Board, out: Path) -> Path:
    """Build the program that makes calls out of a file, for the emulator (sp_batch.c)."""
    plan = read_emission(folder).plan
    ports = ("sp_batch.c", "sp_port.c", TRANSDUCER, *board.sources)
    return _linked(board, out, _copied(folder, out, plan, ports), state_bytes(plan))


def _copied(folder: Path, out: Path, plan: Plan, ports: tuple[str, ...]) -> tuple[str, ...]:
    """Bring the scene's C and these files of the port, with all headers; name what is compiled."""
    out.mkdir(parents=True, exist_ok=True)
    source = f"{scene_prefix(folder)}.c"
    for file in [*folder.glob("*.h"), folder / source]:
        shutil.copyfile(file, out / file.name)
    files = [*PORT_MCU.glob("*.h"), *(PORT_MCU / name for name in ports)]
    write_port(folder, plan.real, files, out)
    return (source, *ports)


def _linked(
    board: Board, out: Path, sources: tuple[str, ...], selftest_bytes: int, strict: bool = False
) -> Path:
    tools = compiler_of(board)
    arguments = [
        *flags("SP_CFLAGS"), *(flags("SP_STRICT") if strict else ()), *tools.flags,
        "-nostartfiles", f"-L{PORT_MCU}", f"-T{PORT_MCU / board.script}",
        # the self-test keeps a state of its own on the stack
        f"-Wl,--defsym=sp_stack_bytes={-(-(_STACK_BYTES + selftest_bytes) // 8) * 8}",
        *(str(out / file) for file in sources), "-lm", "-lc", "-lgcc", "-o", str(out / _PROGRAM),
    ]  # fmt: skip
    try:
        run_compiler(arguments, "the firmware", tools.compiler)
    except CompilerError as error:
        if "overflowed by" not in str(error):
            raise
        raise BudgetError(
            f"{board.name}: the firmware does not fit ({str(error).split(': ')[-1]}): give the "
            "scene a [budget] and `springpot emit --fit`"
        ) from None
    return out / _PROGRAM
