"""The programs that are analysed: scenes of every kind with what they include, and the ports."""

from dataclasses import dataclass, replace
from itertools import cycle
from pathlib import Path
from unittest import mock

import numpy as np
from support.c import golden_forces
from support.c.single import plan_of, with_map
from support.paths import ROOT
from support.small import damage, flow

from springpot.codegen import stages
from springpot.codegen.emit.files import emit_files
from springpot.codegen.model.model import Model
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.plan.plan import Plan
from springpot.codegen.scene import Coupling, Device, Runtime, Scene, Smoothing
from springpot.host.wings.boards.boards import BOARDS

RUNTIME = ROOT / "runtime_c"
PORT = RUNTIME / "port"
_FLOAT, _OFF, _TOOL = Runtime(number="float32"), Coupling(mode="off"), Coupling(mode="tool")
_SETTINGS = (
    (_FLOAT, _OFF),
    (Runtime(number="float64"), _TOOL),
    (_FLOAT, Coupling(mode="proxy")),
)


@dataclass(frozen=True)
class Program:
    """Sources that are linked together, and the folders of their headers."""

    name: str
    sources: tuple[Path, ...]
    include: tuple[Path, ...]


def programs(folder: Path) -> list[Program]:
    """All of them; scenes are emitted into `folder`."""
    return [*_scenes(folder), *_ports()]


def _scenes(folder: Path) -> list[Program]:
    """One scene of every stored model, number types and couplings taking turns; and the units that
    none of them needs."""
    made = [
        _scene(folder, name, golden_forces.model(name), *settings)
        for name, settings in zip(golden_forces.models(), cycle(_SETTINGS), strict=False)
    ]
    hammerstein = golden_forces.model("hammerstein")
    passive = hammerstein.hammerstein
    tau_s = np.array([0.01, 4e3, 0.2, 2.0])  # the second moves in double only
    weight = np.ones((4, 1)) * passive.elastic_n
    laws = replace(
        passive, tau_s=tau_s, branch_n=weight, n_by_depth=2, rate_ratio=16.0, flow=flow(2.0),
        damage=damage(passive.elastic_n), recovers=True,
    )  # fmt: skip
    law = replace(hammerstein, hammerstein=laws)
    made.append(_scene(folder, "laws", law, _FLOAT, _OFF))
    made.append(_written(folder, plan_of("places", with_map(law), "float32", "off")))
    sliding = plan_of("sliding", with_map(hammerstein), "float32", "off", lateral=True)
    made.append(_written(folder, sliding))
    velocity = Device(velocity="device")
    made.append(_scene(folder, "velocity", hammerstein, _FLOAT, _TOOL, velocity))
    with mock.patch.object(stages.forest, "compact_forest", return_value=None):  # as if too big
        made.append(_scene(folder, "wide", golden_forces.model("rf-fd"), _FLOAT, _OFF))
    return made


def _scene(
    folder: Path,
    name: str,
    model: Model,
    runtime: Runtime,
    coupling: Coupling,
    device: Device | None = None,
) -> Program:
    scene = Scene(
        schema=1,
        name=name,
        model=f"{name}.spm",
        runtime=runtime,
        coupling=coupling,
        smoothing=Smoothing(time_constant_s=1e-3),
        device=device or Device(),
    )
    return _written(folder, make_plan(model, scene, accept_unsafe=True))


def _written(folder: Path, plan: Plan) -> Program:
    place = folder / plan.scene.name
    place.mkdir(parents=True, exist_ok=True)
    for file, text in emit_files(plan).items():
        (place / file).write_text(text)
    return Program(f"scene {plan.scene.name}", tuple(sorted(place.glob("*.c"))), ())


def _ports() -> list[Program]:
    """The loop of a PC, the bench, a page's side, and each board's firmware and replay."""
    wire = PORT / "wire" / "sp_wire.c"
    headers = (RUNTIME / "include", RUNTIME / "include" / "float", RUNTIME / "src")
    mcu = PORT / "mcu"
    made = [
        Program("loop", (*sorted((PORT / "posix").glob("*.c")), wire),
                (*headers, RUNTIME / "sim", wire.parent)),
        Program("bench", tuple(sorted((PORT / "testbench").glob("*.c"))),
                (*headers, RUNTIME / "sim")),
        Program("page", (PORT / "browser" / "sp_page.c", wire),
                (*headers, RUNTIME / "sim", wire.parent)),
        *(Program(f"page {name}", tuple(PORT / "browser" / f"sp_page_{its}.c"
                                        for its in ("map", "survey", name)),
                  (*headers, RUNTIME / "sim"))
          for name in ("held", "slid")),
    ]  # fmt: skip
    for sources in sorted({board.sources for board in BOARDS.values()}):
        board = tuple(mcu / name for name in sources)
        common = (mcu / "sp_port.c", mcu / "sp_transducer.c", *board)
        name = board[-1].stem.removeprefix("sp_board_")
        made += [
            Program(f"firmware {name}", (mcu / "sp_firmware.c", wire, *common),
                    (*headers, wire.parent)),
            Program(f"replay {name}", (mcu / "sp_batch.c", *common), headers),
        ]  # fmt: skip
    return made
