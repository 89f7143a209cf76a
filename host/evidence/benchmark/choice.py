"""A model and a scene from a benchmark: by the name of a pick, or by a budget of one's own."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from springpot import Scene
from springpot.codegen.errors import BudgetError, DataError, UnsafeError, UsageError
from springpot.codegen.scene import Budget, Target
from springpot.host.console.output import say
from springpot.host.evidence.benchmark.isolated import rendered_scene
from springpot.host.evidence.benchmark.labels import point_line
from springpot.host.evidence.benchmark.picks import PlatformBudget, misfit, pick, unmeasured
from springpot.host.evidence.benchmark.point import Point, points_of
from springpot.host.evidence.benchmark.store import Store, read_result


def chosen_scene(
    folder: Path,
    picked: str | None,
    limits: Mapping[str, Any],
    accept_unsafe: bool,
    stated: Scene | None,
) -> tuple[Scene, Path]:
    """Choose what `springpot emit` emits: by the name of a pick, or by limits of one's own.

    limits: tick_us, flash_bytes, ram_bytes, as of PlatformBudget. stated: keys of the scene file,
    which override the pick. Raises as `choose_pick`, `choose_within` and `scene_of`.
    """
    if picked is not None:
        return scene_of(folder, *choose_pick(folder, picked, accept_unsafe), stated)
    budget = PlatformBudget("chosen", "chosen", **limits)
    return scene_of(folder, *choose_within(folder, budget), stated)


def choose_pick(
    folder: Path, name: str, accept_unsafe: bool = False
) -> tuple[Point, PlatformBudget]:
    """Return the point of a pick, and its budget.

    Raises UsageError for an unknown name, BudgetError where no model fits it, UnsafeError where
    the pick is not bounded in the closed loop, unless that is accepted.
    """
    result = read_result(folder)
    found = result["picks"].get(name)
    if found is None:
        known = ", ".join(result["picks"])
        raise UsageError(f"--pick {name}: no such pick in {folder}: it has {known}")
    budget = PlatformBudget(**found["budget"])
    if found["point"] is None:
        raise BudgetError(f"--pick {name}: {found['why']}: give --flash, --ram or --budget-us")
    point: Point = next(p for p in points_of(result) if p.key == found["point"])
    if not point.bounded and not accept_unsafe:
        raise UnsafeError(
            f"--pick {name}: {found['why']}; or emit with --accept-unsafe, for replay"
        )
    return point, budget


def choose_within(folder: Path, budget: PlatformBudget) -> tuple[Point, PlatformBudget]:
    """Choose the most accurate stable point that fits, among those of the front and the picks.

    Raises BudgetError with the point that comes nearest, or if a limit cannot be checked.
    """
    result = read_result(folder)
    points = points_of(result)
    for why in filter(None, (unmeasured(point, budget) for point in points)):
        raise BudgetError(
            f"--flash {budget.flash_bytes}: {why}: install it and run the benchmark again, "
            "which adds the sizes; or leave out --flash"
        )
    stable = [p for p in points if p.bounded and not p.active_cells]
    if not stable:
        raise BudgetError(f"{folder}: no stable model at all: record more, or sweep more kinds")
    found = pick(stable, budget, result["rate_hz"], lambda point: point)
    if found is None:
        nearest = min(stable, key=lambda p: (p.flash_bytes or 0, p.tick_ns_hot))
        raise BudgetError(
            f"no stable model of {folder} fits; the smallest, {misfit(nearest, budget, 1.0)}, is "
            f"{point_line(nearest)}: raise the budget"
        )
    return found, budget


def scene_of(
    folder: Path, point: Point, budget: PlatformBudget, stated: Scene | None
) -> tuple[Scene, Path]:
    """Return the scene to emit and its model file; stated: keys of the scene file, which override.

    Raises DataError where the bench folder has lost the model.
    """
    result = read_result(folder)
    model_file = Store(folder).model_file(point.key)
    if not model_file.exists():
        raise DataError(f"{model_file}: missing: run the command of {folder} again, it resumes")
    say(f"{budget.title}: {point_line(point)}")
    if budget.rate_hz is not None and budget.rate_hz > 1.001 * result["rate_hz"]:
        say(
            f"the C runs at the recordings' {result['rate_hz']:g} Hz; its tick leaves time for "
            f"{budget.rate_hz:g} Hz"
        )
    if stated is not None:
        return replace(stated, runtime=replace(stated.runtime, number=point.number)), model_file
    on_board = budget.flash_bytes is not None or budget.ram_bytes is not None
    target: Target = result["target"] if on_board else "host"
    limits = Budget(flash_bytes=budget.flash_bytes, ram_bytes=budget.ram_bytes)
    return replace(rendered_scene(budget.name, point.number, target), budget=limits), model_file
