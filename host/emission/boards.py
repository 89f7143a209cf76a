"""Boards with a port: the firmware of a scene, and its calls on an emulated board, counted."""

import re
import shlex
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.arrays import Reals
from springpot.codegen.emit.golden import LEG_TICKS, differentiate, golden_positions
from springpot.codegen.errors import BudgetError, MismatchError, SpringpotError, UsageError
from springpot.codegen.files import write_folder_atomically
from springpot.codegen.messages import short_repr
from springpot.codegen.native.compiler import CompilerError, run_compiler
from springpot.codegen.notes import HELD, RESYNC
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.scene import Target
from springpot.codegen.stages.expressions import require_no_libm
from springpot.host.emission.checksums import is_edited, require_replaceable, write_checksums
from springpot.host.native.scene_library import SceneLibrary, scene_prefix, write_port
from springpot.host.native.toolchain import PROGRAMS, Toolchain, missing_tools, toolchain
from springpot.host.stability.check import require_held
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
    """Return the first board of a target; None for a PC."""
    return next((board for board in BOARDS.values() if board.target == target), None)


def find_board(name: str) -> Board:
    """Return the board of a name. Raises UsageError with all names."""
    if name not in BOARDS:
        raise UsageError(f"{name}: no such board: use {', '.join(BOARDS)}")
    return BOARDS[name]


def find_board_compiler(board: Board) -> Toolchain:
    """Return the board's compiler. Raises UsageError with what to install."""
    tools = toolchain(board.target)
    if tools is None:
        raise UsageError(missing_tools(board.target))
    return tools


def find_emulator(board: Board) -> str:
    """Return the path of the board's emulator. Raises UsageError with what to install."""
    program = shutil.which(board.emulator)
    if program is None:
        package, _ = PROGRAMS[board.emulator]
        raise UsageError(f"no {board.emulator}: `apt-get install {package}`")
    return program


def missing(board: Board) -> str:
    """List what is missing to build for the board and to emulate it."""
    for find in (find_board_compiler, find_emulator):
        try:
            find(board)
        except UsageError as error:
            return str(error)
    return ""


def build_firmware(folder: Path, plan: Plan, board: Board, out: Path, strict: bool = False) -> Path:
    """Build the firmware of an emitted folder into `out`, with all its sources beside it.

    An earlier firmware there is replaced; TRANSDUCER, where its user changed it, is built as it is.
    Raises UsageError without a compiler, or where `out` holds anything else or other changes,
    BudgetError where it does not fit the board, UnsafeError where a hand could not hold it.
    """
    require_replaceable(out, yours=[TRANSDUCER])
    require_held(plan, SceneLibrary(folder))
    with write_folder_atomically(out) as aside:
        sources = _copied(folder, aside, plan, board, _COMMON)
        line = shlex.join([*find_board_compiler(board).compiler, *_arguments(board, plan, sources)])
        rule = f"{_PROGRAM}: $(wildcard *.c *.h *.ld)\n\t{line}\n"
        (aside / "Makefile").write_text(rule, encoding="utf-8", newline="\n")
        write_checksums(aside)
        if is_edited(out, TRANSDUCER):
            shutil.copyfile(out / TRANSDUCER, aside / TRANSDUCER)
        _link(board, [*(flags("SP_STRICT") if strict else ()),
                             *_arguments(board, plan, sources, aside)])  # fmt: skip
    return out / _PROGRAM


def build_batch(folder: Path, plan: Plan, board: Board, out: Path) -> Path:
    """Build the program that makes calls out of a file, for the emulator (sp_batch.c)."""
    sources = _copied(folder, out, plan, board, ("sp_batch.c", "sp_port.c", TRANSDUCER))
    _link(board, _arguments(board, plan, sources, out))
    return out / _PROGRAM


def _copied(
    folder: Path, out: Path, plan: Plan, board: Board, ports: tuple[str, ...]
) -> tuple[str, ...]:
    """Copy the scene's C and the port's files to a folder; name the sources to compile."""
    ports += board.sources
    require_no_libm(plan.model.regressor, "a bare board")
    out.mkdir(parents=True, exist_ok=True)
    source = f"{scene_prefix(folder)}.c"
    for file in [*folder.glob("*.h"), folder / source]:
        shutil.copyfile(file, out / file.name)
    script = (PORT_MCU / board.script).read_text(encoding="utf-8")
    named = (*ports, board.script, *re.findall(r"^INCLUDE (\S+)", script, re.M))
    files = [*PORT_MCU.glob("*.h"), *(PORT_MCU / name for name in named)]
    write_port(folder, plan.real, files, out)
    return (source, *ports)


def _arguments(
    board: Board, plan: Plan, sources: tuple[str, ...], folder: Path = Path()
) -> list[str]:
    """Return the compiler's words that make a firmware of the sources in a folder."""
    # The self-test keeps a state of its own on the stack.
    stack_bytes = -(-(_STACK_BYTES + state_bytes(plan)) // 8) * 8
    return [
        *flags("SP_CFLAGS"), *find_board_compiler(board).flags, "-nostartfiles", f"-L{folder}",
        f"-T{folder / board.script}", f"-Wl,--defsym=sp_stack_bytes={stack_bytes}",
        *(str(folder / file) for file in sources), "-lm", "-lc", "-lgcc",
        "-o", str(folder / _PROGRAM),
    ]  # fmt: skip


def _link(board: Board, arguments: list[str]) -> None:
    """Compile and link a firmware. Raises BudgetError where it does not fit the board."""
    try:
        run_compiler(arguments, "the firmware", find_board_compiler(board).compiler)
    except CompilerError as error:
        if "overflowed by" not in str(error):
            raise
        raise BudgetError(
            f"{board.name}: the firmware does not fit ({str(error).split(': ')[-1]}): give the "
            "scene a [budget] and `springpot emit --fit`"
        ) from None


CALL_IDLE, CALL_RESET = 1, 2  # CALL_IDLE, CALL_RESET of sp_batch.c
_SHIFT = 8  # an instruction takes 2^8 ns of the emulated time: several counts of every counter
_OVERFLOWED = 0xFFFFFFFF  # OVERFLOWED of sp_batch.c
_EMULATOR_TIMEOUT_S = 600.0


@dataclass(frozen=True, eq=False)
class Batch:
    """Results of each call on the board: force_n, notes, instructions; shapes (n,)."""

    force_n: Reals
    notes: NDArray[np.int32]
    instructions: NDArray[np.int64]


def steps(position_m: Reals, velocity_mps: Reals) -> NDArray[np.void]:
    """Return plain ticks, one a position: rows (n,) of calls to make, in the scene's type.

    `call` of a row takes CALL_IDLE, for which `dt_s` is, and CALL_RESET.
    """
    real = position_m.dtype
    names = [("call", "<u4"), ("position_m", real), ("velocity_mps", real), ("dt_s", real)]
    rows = np.zeros(len(position_m), dtype=np.dtype(names, align=real.itemsize == 8))
    rows["position_m"], rows["velocity_mps"] = position_m, velocity_mps
    return rows


def run_batch(folder: Path, plan: Plan, board: Board, rows: NDArray[np.void]) -> Batch:
    """Make the calls of `steps` on the emulated board, from a fresh state.

    Raises UsageError without the tools, MismatchError where the scene's self-test fails there.
    """
    real = rows.dtype["position_m"]
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        place = Path(scratch)
        program = build_batch(folder, plan, board, place)
        rows.tofile(place / "calls.bin")
        emulate(board, program, place)
        names = [("force_n", real), ("notes", "<i4"), ("counts", "<u4")]
        row = np.dtype(names, align=real.itemsize == 8)
        returned = np.fromfile(place / "returns.bin", dtype=row)
    if len(returned) != 1 + len(rows):
        raise SpringpotError(
            f"{board.name}: {max(len(returned) - 1, 0)} of {len(rows)} calls returned: the "
            "firmware stopped"
        )
    if differs := int(returned["notes"][0]):
        raise MismatchError(
            f"{board.name}: the self-test differs at golden tick {differs - 1}: report the compiler"
        )
    counts = returned["counts"].astype(np.int64)
    if counts.max() >= _OVERFLOWED:
        raise SpringpotError(
            f"{board.name}: call {int(counts.argmax()) - 1} took more instructions than its "
            "counter can hold: count on another board"
        )
    per_count = 1e9 / board.counter_hz / (1 << _SHIFT)
    return Batch(
        force_n=returned["force_n"][1:],
        notes=returned["notes"][1:],
        instructions=np.round((counts[1:] - counts[0]) * per_count).astype(np.int64),
    )


@dataclass(frozen=True)
class TickCost:
    """The most instructions of a tick, usually and after a silence; None: not counted, and why."""

    usual: int | None
    after_silence: int | None
    why: str


def count_instructions(folder: Path, plan: Plan) -> TickCost:
    """Count on the target's emulated board, over the motion of the self-test.

    The longest silence that does not latch comes before four ticks: each makes up for it.
    """
    board = default_board(plan.scene.runtime.target)
    if board is None:
        return TickCost(None, None, "a PC has no emulated board: give a target")
    if why := missing(board):
        return TickCost(None, None, why)
    position = golden_positions(plan)
    at = np.arange(LEG_TICKS // 2, 5 * LEG_TICKS, 5 * LEG_TICKS // 4)
    rows = np.insert(steps(position, differentiate(position, plan.dt_s)), at, np.zeros(1))
    at += np.arange(len(at))
    rows["call"][at], rows["dt_s"][at] = CALL_IDLE, plan.watchdog_s - plan.dt_s
    try:
        batch = run_batch(folder, plan, board, rows)
    except SpringpotError as error:
        return TickCost(None, None, str(error))
    lost = np.asarray((batch.notes & (HELD | RESYNC)) != 0)  # a restart is no tick of a loop
    usual = ~lost & ~np.roll(lost, 1)
    return TickCost(
        int(batch.instructions[usual].max()),
        int(batch.instructions[at + 1].max()),
        f"emulated {board.name}",
    )


def emulate(board: Board, program: Path, place: Path) -> None:
    """Run a program on the emulated board; its files are in `place`, and "returns.bin" is written.

    Raises UsageError without the emulator, SpringpotError where it fails.
    """
    command = [
        find_emulator(board), "-M", board.name, *board.options, "-display", "none",
        "-monitor", "none", "-serial", "null",
        "-semihosting-config", "enable=on,target=native", "-icount", f"shift={_SHIFT},sleep=off",
        "-kernel", str(program),
    ]  # fmt: skip
    try:
        result = subprocess.run(
            command,
            cwd=place,
            capture_output=True,
            text=True,
            check=False,
            timeout=_EMULATOR_TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        raise SpringpotError(
            f"{board.name}: no end after {_EMULATOR_TIMEOUT_S:g} s of emulation"
        ) from None
    if result.returncode != 0 or not (place / "returns.bin").exists():
        raise SpringpotError(f"{board.name}: the emulator failed: {result.stderr.strip()[:300]}")
