"""Boards that springpot brings a port for, by the name that the emulator gives them."""

import shutil
from dataclasses import dataclass

from springpot.codegen.errors import UsageError
from springpot.codegen.messages import short_repr
from springpot.codegen.scene import Target
from springpot.host.native.toolchain import Toolchain, missing_tools, toolchain


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


_MPS2 = ("mps2.ld", ("sp_arm.c", "sp_board_mps2.c"), "qemu-system-arm")
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
_EMULATOR_PACKAGES = {
    "qemu-system-arm": "qemu-system-arm",
    "qemu-system-riscv32": "qemu-system-misc",
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
        package = _EMULATOR_PACKAGES[board.emulator]
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
