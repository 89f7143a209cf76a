"""What `make bench-tick` times: libraries with a step function, and how each was made."""

import dataclasses
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.model.features import FirBank
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import write_model
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import find_compiler
from springpot.codegen.scene import Coupling, Guard, Scene, Smoothing
from springpot.host.emission.emission import emit
from springpot.host.native.replay import load_port
from springpot.runtime_c.paths import flags

HERE = Path(__file__).parent
PAPER_SMOOTHING_S = 0.000831  # the paper's weight of 0.7 at 1 kHz


@dataclass(frozen=True, eq=False)
class Row:
    """A step function in a library; bytes: code and tables. vectors: cap on the vector unit."""

    what: str
    library: Path
    step: str
    state_bytes: int
    init: str | None
    bytes: int
    write_s: float
    compile_s: float
    vectors: int = 0


def scene_rows(model: Model, names: dict[int, str], folder: Path, **overrides: Any) -> list[Row]:
    """A whole tick with the paper's coupling and smoothing, per cap on the vector unit.

    Outside the trained depth the force is held: the literal tick has no fallback either.
    """
    folder.mkdir(parents=True)
    write_model(folder / "model.spm", model)
    scene = Scene(
        schema=1, name=folder.name, model="model.spm", coupling=Coupling(mode="tool"),
        smoothing=Smoothing(time_constant_s=PAPER_SMOOTHING_S), guard=Guard(outside="hold"),
    )  # fmt: skip
    scene = dataclasses.replace(scene, **overrides)
    emission = emit(scene, folder / "model.spm", folder / "c", accept_unsafe=True)
    rows = []
    for cap, what in names.items():
        library = folder / f"simd{cap}.so"
        begin = time.perf_counter()
        compiled([folder / "c" / "sp.c"], library, [f"-I{folder / 'c'}", f"-DSP_SIMD={cap}"])
        compile_s = time.perf_counter() - begin
        rows.append(
            Row(what, library, "sp_step", emission.ram_bytes, "sp_init",
                emission.footprint.flash_bytes, emission.write_s, compile_s, cap)
        )  # fmt: skip
    return rows


def literal_row(ensemble: Any, scale: float, bank: FirBank, folder: Path) -> Row:
    """Plain taps and m2cgen's nested ifs at -O1; taps scaled as the ensemble was fitted."""
    import m2cgen

    folder.mkdir(parents=True)
    sys.setrecursionlimit(100_000)
    begin = time.perf_counter()
    text = m2cgen.export_to_c(ensemble)
    (folder / "score.c").write_text(text)
    write_s = time.perf_counter() - begin
    rows = ",\n".join("{" + ", ".join(map(repr, row.tolist())) + "}" for row in scale * bank.taps.T)
    length, orders = bank.taps.shape
    (folder / "literal_taps.h").write_text(
        f"enum {{ N_TAPS = {length}, N_ORDERS = {orders} }};\n"
        f"static const double taps[N_ORDERS][N_TAPS] = {{\n{rows}\n}};\n"
    )
    begin = time.perf_counter()
    score = folder / "score.o"
    subprocess.run(
        [*find_compiler(), "-O1", "-fPIC", "-c", folder / "score.c", "-o", score], check=True
    )
    compile_s = time.perf_counter() - begin
    library = folder / "literal.so"
    compiled([HERE / "tick_literal.c", score], library, [f"-I{folder}"])
    state_bytes = CLibrary(library, "uint32_t literal_size(void);").c.literal_size()
    return Row("literal", library, "literal_step", state_bytes, None, code_bytes(score), write_s,
               compile_s)  # fmt: skip


def compiled(sources: list[Path], library: Path, extra: list[str]) -> None:
    """Shared library of C sources, with the project's flags."""
    command = [
        *find_compiler(),
        *flags("SP_CFLAGS"),
        *flags("SP_SHARED"),
        *extra,
        *map(str, sources),
    ]
    subprocess.run([*command, "-o", str(library)], check=True)


def code_bytes(built: Path) -> int:
    """Code, constants and initialised data of an object file."""
    told = subprocess.run(["size", str(built)], capture_output=True, text=True, check=True).stdout
    text, data, *_ = told.splitlines()[1].split()
    return int(text) + int(data)


class Stepper:
    """Calls a row's step function through the replay port, hot or paced."""

    def __init__(self, row: Row, positions: np.ndarray, velocities: np.ndarray) -> None:
        self.row = row
        self._port = load_port("float")
        init = f"void {row.init}(void *);" if row.init else ""
        self._library = CLibrary(row.library, f"void {row.step}(void);{init}")
        c = self._library.c
        self._step = self._port.pointer(self._library.address(getattr(c, row.step)))
        self._state = self._library.memory(row.state_bytes)
        if row.init:
            getattr(c, row.init)(self._state)
        self._positions = np.ascontiguousarray(positions, dtype=np.float32)
        self._velocities = np.ascontiguousarray(velocities, dtype=np.float32)
        self.force_n = np.empty_like(self._positions)
        self._notes = np.empty(len(positions), dtype=np.int32)

    def hot_ns(self, begin: int, ticks: int) -> float:
        """Mean time of `ticks` ticks in a tight loop, ns."""
        rows = slice(begin, begin + ticks)
        arrays = self._positions[rows], self._velocities[rows], self.force_n[rows]
        pointers = [*map(self._port.array, (*arrays, self._notes[rows]))]
        clock = time.perf_counter_ns()
        self._port.c.sp_replay(self._step, self._state, ticks, *pointers)
        return (time.perf_counter_ns() - clock) / ticks

    def paced_ns(self, ticks: int, period_s: float, cold: np.ndarray) -> np.ndarray:
        """Time of each of `ticks` ticks on deadlines with disturbed caches, ns."""
        tick_ns = np.empty(ticks)
        array = self._port.array
        error = self._port.c.sp_replay_time_ticks(
            self._step, self._state, ticks, array(self._positions[:ticks]),
            array(self._velocities[:ticks]), period_s, array(cold), len(cold), array(tick_ns),
        )  # fmt: skip
        assert error == 0
        return tick_ns
