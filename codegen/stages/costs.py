"""Instructions of the parts of a tick, by target.

Of flags.mk's flags with gcc 12 on the target, a little above what the emulated boards counted;
tests hold the bounds that are made of them against the count for every kind of scene.
"""

from dataclasses import dataclass

from springpot.codegen.scene import Target


@dataclass(frozen=True)
class Costs:
    """Instructions: fixed parts, and of each element of a unit."""

    tick: float
    coupling: float
    tap: float
    tap_row: float
    pole: float
    slow_pole: float
    direct: float
    weight: float
    lane: float
    lag: float
    velocity_step: float
    bin_step: float
    bin_search: float
    quantisation: float
    tree: float
    tree_round: float
    center: float
    passive: float
    branch: float
    branch_depth: float
    curve: float
    stop: float
    flow: float
    flow_branch: float
    damage: float
    surface: float
    surface_piece: float
    filled: float
    rest: float


_THUMB = Costs(
    tick=164, coupling=75, tap=4.5, tap_row=100, pole=16, slow_pole=500, direct=7,
    weight=4.6, lane=10, lag=14, velocity_step=29, bin_step=14, bin_search=50, quantisation=22,
    tree=72, tree_round=28, center=13, passive=34, branch=24, curve=16,
    branch_depth=12, stop=50, flow=34, flow_branch=60, damage=40, surface=50, surface_piece=9,
    filled=3.1, rest=2,
)  # fmt: skip
_RISCV = Costs(
    tick=150, coupling=85, tap=4.6, tap_row=110, pole=20, slow_pole=700, direct=8,
    weight=6.0, lane=12, lag=16, velocity_step=27, bin_step=15, bin_search=60, quantisation=36,
    tree=90, tree_round=38, center=13, passive=34, branch=27, curve=16,
    branch_depth=12, stop=54, flow=34, flow_branch=60, damage=32, surface=50, surface_piece=9,
    filled=3.1, rest=16,
)  # fmt: skip
COSTS: dict[Target, Costs] = {"cortex-m4f": _THUMB, "cortex-m7": _THUMB, "rv32imafc": _RISCV}
