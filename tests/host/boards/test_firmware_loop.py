"""The firmware: its loop gives the forces of the scene, bit for bit; its user's files stand."""

import shutil
import subprocess
import zlib
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest
from support.c.mcu import need, target_scene
from support.paths import C_TESTS, TESTS
from support.small import DT_S, model_file, press, scene

from springpot.codegen.errors import UsageError
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.host.emission.boards import (
    BOARDS,
    TRANSDUCER,
    build_batch,
    build_firmware,
    emulate,
    find_board_compiler,
)
from springpot.host.emission.emission import emit, read_emission
from springpot.host.native.scene_library import SceneLibrary, write_port
from springpot.runtime_c.paths import PORT_MCU, flags

WATCHDOG = 20  # periods
DECLARATION = "uint32_t harness_run(const float *, const uint32_t *, uint32_t, float *);"
TRANSDUCER_OF_TEST = TESTS / "support" / "c" / "mcu_transducer.c"


def motion(missing: slice) -> np.ndarray:
    """Positions of a press, (n,), m; NaN where no sample came."""
    position_m = press(2.0, 0.008, cycles=1).astype(np.float32)
    position_m[missing] = np.nan
    return position_m


def expected(folder: Path, position_m: np.ndarray, periods: list[int]) -> np.ndarray:
    """Forces of the scene: an idle call for what passed, and a step where a sample came."""
    state, forces_n = SceneLibrary(folder).new_state(), []
    for x, passed in zip(position_m[np.cumsum(periods) - 1].tolist(), periods, strict=True):
        idle = passed if np.isnan(x) else passed - 1
        force_n = state.idle(np.float32(DT_S) * idle)[0] if idle else 0.0
        forces_n.append(force_n if np.isnan(x) else state.step(x)[0])
    return np.array(forces_n, dtype=np.float32)


def harness(folder: Path, *options: str) -> CLibrary:
    write_port(folder, "float", [], folder.parent)
    # The harness includes it: built anew where it changed.
    included = zlib.crc32((PORT_MCU / "sp_firmware.c").read_bytes())
    built = shared_library(
        [C_TESTS / "firmware_harness.c", folder / "sp.c"],
        [folder.parent, folder, PORT_MCU],
        [f"-DTEST_OF_FIRMWARE={included}u", *options],
    )
    return CLibrary(built, DECLARATION)


def forces(library: CLibrary, rows: np.ndarray, periods: list[int]) -> np.ndarray:
    """What the motor was given, with so many periods in each sleep."""
    assert sum(periods) == len(rows)
    found = np.zeros(len(periods) + 1, dtype=np.float32)
    n = library.c.harness_run(
        library.ffi.from_buffer("float[]", np.ascontiguousarray(rows)),
        library.ffi.new("uint32_t[]", periods), len(rows),
        library.ffi.from_buffer("float[]", found),
    )  # fmt: skip
    return found[:n]


@pytest.mark.parametrize("missing", [0, 1, WATCHDOG - 5, WATCHDOG + 5])
def test_each_period_is_a_call_of_the_scene(tmp_path: Path, missing: int) -> None:
    emit(scene(mode="proxy"), model_file(tmp_path), tmp_path / "c")
    rows = motion(slice(150, 150 + missing))
    library = harness(tmp_path / "c")
    late = ([1] * 37 + [3]) * (len(rows) // 40)  # always late, it would latch
    for periods in ([1] * len(rows), [*late, *[1] * (len(rows) - sum(late))]):
        steps = expected(tmp_path / "c", rows, periods)
        assert steps.max() > 0.5  # and zero for good, if latched
        assert (missing > WATCHDOG) == (not steps[len(steps) * 2 // 5 :].any())
        assert forces(library, rows, periods).tobytes() == steps.tobytes()


def test_a_scene_whose_self_test_fails_renders_nothing(tmp_path: Path) -> None:
    emit(scene(), model_file(tmp_path), tmp_path / "c")
    source, begin = tmp_path / "c" / "sp.c", "int sp_selftest(void)\n{\n"
    assert begin in source.read_text()
    source.write_text(source.read_text().replace(begin, f"{begin}    return 7;\n"))
    rows = motion(slice(0, 0))
    assert len(forces(harness(tmp_path / "c"), rows, [1] * len(rows))) == 0


@pytest.mark.board
@pytest.mark.slow
@pytest.mark.parametrize("board", list(BOARDS))
def test_an_emulated_board_renders_by_its_timer(tmp_path: Path, board: str) -> None:
    """A sensor that misses some samples, and then so many that the watchdog latches."""
    need(board)
    emit(target_scene(BOARDS[board].target, mode="proxy"), model_file(tmp_path), tmp_path / "c")
    out = tmp_path / "firmware"
    build_firmware(tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS[board], out)
    shutil.copyfile(TRANSDUCER_OF_TEST, out / TRANSDUCER)
    program = build_firmware(
        tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS[board], out, strict=True
    )
    rows = motion(slice(100, 105))
    rows[300 : 300 + 2 * WATCHDOG] = np.nan
    (tmp_path / "calls.bin").write_bytes(rows.tobytes())
    emulate(BOARDS[board], program, tmp_path)
    steps = expected(tmp_path / "c", rows, [1] * len(rows))
    assert steps.max() > 0.5 and not steps[300 + WATCHDOG + 5 :].any()
    assert (tmp_path / "returns.bin").read_bytes() == steps.tobytes()


MODES = ["off", "tool", "proxy"]
TRIPLES = {"cortex-m4f": "thumbv7em-none-eabihf", "cortex-m7": "thumbv7em-none-eabihf",
           "rv32imafc": "riscv32-unknown-elf"}  # fmt: skip


@pytest.mark.board
@pytest.mark.slow
@pytest.mark.parametrize(("board", "mode"), list(zip(BOARDS, cycle(MODES), strict=False)))
def test_gcc_and_clang_of_the_target(tmp_path: Path, board: str, mode: str) -> None:
    """Couplings take turns: all boards have one C (test_every_board.py)."""
    need(board)
    clang = shutil.which("clang")
    if clang is None:
        pytest.skip("no clang: `apt-get install clang`")
    target = BOARDS[board].target
    emit(target_scene(target, mode=mode), model_file(tmp_path), tmp_path / "c")
    assert build_firmware(
        tmp_path / "c",
        read_emission(tmp_path / "c").plan,
        BOARDS[board],
        tmp_path / "f",
        strict=True,
    ).exists()
    build_batch(tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS[board], tmp_path / "f")
    compiler = find_board_compiler(BOARDS[board])
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


@pytest.mark.board
@pytest.mark.slow
def test_the_users_files_stand(tmp_path: Path) -> None:
    need(BOARD)
    emit(target_scene("cortex-m4f"), model_file(tmp_path), tmp_path / "c")
    out = tmp_path / "firmware"

    def build() -> bytes:
        return build_firmware(
            tmp_path / "c", read_emission(tmp_path / "c").plan, BOARDS[BOARD], out
        ).read_bytes()

    plain = build()
    assert build() == plain
    (out / "firmware.elf").unlink()
    subprocess.run(["make", "-C", out], check=True, capture_output=True)  # without springpot
    assert (out / "firmware.elf").read_bytes() == plain
    own = (out / TRANSDUCER).read_text().replace("return 0;", "*position_m = 1e-3f; return 1;")
    (out / TRANSDUCER).write_text(own)
    changed = build()
    assert changed != plain and (out / TRANSDUCER).read_text() == own and build() == changed
    (out / "sp_port.c").write_text("/* mine */\n" + (out / "sp_port.c").read_text())
    with pytest.raises(UsageError, match=r"sp_port.c: not as springpot emitted it: move your"):
        build()
    assert (out / "sp_port.c").read_text().startswith("/* mine */")
