"""What was emitted, and its sizes against the budget of the scene."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.errors import BudgetError
from springpot.codegen.plan import Plan, instruction_bound
from springpot.codegen.scene import Budget
from springpot.codegen.types import JsonObject
from springpot.host.native.footprint import Footprint
from springpot.host.stability.check import Check

# Keys of `emit --json` that the manifest has too; instructions and forest of some scenes only.
_OF_MANIFEST = ("instructions", "units", "left_out", "orders", "coupling", "outside",
                "accept_unsafe")  # fmt: skip


@dataclass(frozen=True)
class Emission:
    """What was emitted. footprint, compile_s, check: None without a compiler; notices say why.

    unmeasured: why there is no footprint, and what to install; empty where there is one.

    >>> emission = emit("c", model=model)
    >>> emission.ram_bytes < 1000
    True
    """

    folder: Path
    plan: Plan
    manifest: JsonObject
    hash: str
    footprint: Footprint | None
    unmeasured: str
    ram_bytes: int
    write_s: float
    compile_s: float | None
    check: Check | None
    notices: tuple[str, ...]

    def __repr__(self) -> str:
        flash = f"flash {self.flash_bytes}, " if self.footprint else ""
        return f"Emission({str(self.folder)!r}, {flash}RAM {self.ram_bytes} bytes)"

    @property
    def flash_bytes(self) -> int | None:
        """Code, constants and initialised data of the scene; None without a compiler."""
        return self.footprint.flash_bytes if self.footprint else None

    def as_dict(self) -> JsonObject:
        """Keys of `emit --json`."""
        footprint = self.footprint
        return {
            "out": str(self.folder),
            "hash": self.hash,
            "flash_bytes": self.flash_bytes,
            "ram_bytes": self.ram_bytes,
            "stack_bytes": footprint.stack_bytes if footprint else None,
            **{key: self.manifest.get(key) for key in _OF_MANIFEST},
            "stability": self.check.as_dict() if self.check else None,
            "write_s": self.write_s,
            "compile_s": self.compile_s,
        }


def over_budget(emission: Emission, budget: Budget) -> str:
    """All sizes that are over the budget, with the budget's; nothing if all fit.

    Raises BudgetError if a size that has a budget is not known: which, why, what to do.
    """
    missing = emission.unmeasured
    whys = {
        "flash": missing,
        "stack": missing or "this compiler does not report it: use gcc",
        "a tick": "the bound of instructions does not cover this scene: measure it on the board",
    }
    over = []
    for what, unit, has, may in budgeted_sizes(emission, budget):
        if has is None:
            raise BudgetError(
                f"{what}: could not be measured for its budget of {may} {unit}: {whys[what]}; or "
                "remove the budget's key"
            )
        if has is not None and has > may:
            over.append(f"{what}: {has} {unit}, the scene's budget is {may}")
    return "; ".join(over)


def budgeted_sizes(
    emission: Emission, budget: Budget
) -> Iterator[tuple[str, str, int | None, int]]:
    """Of each size that has a budget: name, unit, value (None: not known), limit."""
    found = emission.footprint
    bound = instruction_bound(emission.plan)
    for what, unit, has, may in (
        ("flash", "bytes", found.flash_bytes if found else None, budget.flash_bytes),
        ("RAM", "bytes", emission.ram_bytes, budget.ram_bytes),
        ("stack", "bytes", found.stack_bytes if found else None, budget.stack_bytes),
        ("a tick", "instructions", bound.tick if bound else None, budget.tick_instructions),
    ):
        if may is not None:
            yield what, unit, has, may
