"""The Pareto front of a benchmark, and the point to pick for each budget."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from springpot.basics import Target
from springpot.host.wings.evidence.benchmark.point import Point
from springpot.native import SOFT_DOUBLES

ERROR_TOLERANCE = 1.005  # of the lowest error: of two within it, the faster is taken,
_FASTER = 0.9  # where its time is below this share of the other's: timing has noise
MAX_TRIED = 4  # closed loops that are not bounded: then it is the object, not the model
PERIOD_SHARE = 0.1  # of the period that a tick may take on a PC, that does other work too
_AXES = ("cv_rmse_n", "tick_ns_hot", "flash_bytes")


@dataclass(frozen=True)
class PlatformBudget:
    """What a device has to spare; None is no limit.

    tick_us: on this machine, 99 of 100 ticks. target: None is this machine. instructions: of a
    tick on the target, checked where they are counted.
    rate_hz: of the loop; None: any, the recordings' own.
    """

    name: str
    title: str
    rate_hz: float | None = None
    tick_us: float | None = None
    flash_bytes: int | None = None
    ram_bytes: int | None = None
    instructions: int | None = None
    target: Target | None = None


def budgets(target: Target) -> tuple[PlatformBudget, ...]:
    """Return a PC at 1 and at 4 kHz that spares a tenth of a period, and the board.

    A board has 256 kB of flash and spares 8 000 instructions a tick.
    """
    pcs = tuple(
        PlatformBudget(f"pc-{khz}khz", f"PC at {khz} kHz", rate_hz=1e3 * khz,
                       tick_us=1e3 * PERIOD_SHARE / khz)
        for khz in (1, 4)
    )  # fmt: skip
    if target == "host":
        return pcs
    board = PlatformBudget(
        target, f"board with a {target}", flash_bytes=256 * 1024, ram_bytes=64 * 1024,
        instructions=8000, target=target,
    )  # fmt: skip
    return (*pcs, board)


def pareto(points: Sequence[Point]) -> set[str]:
    """Return keys of the points that no other beats in error, time and flash alike.

    The error is the cross-validated one: the validation recordings only report.
    """
    rows = {p.key: tuple(getattr(p, axis) for axis in _AXES) for p in points}
    return {key for key, row in rows.items() if not any(_beats(o, row) for o in rows.values())}


def _beats(one: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    """Return whether one is better and nowhere worse, in what is known of both."""
    known = [(a, b) for a, b in zip(one, other, strict=True) if a is not None and b is not None]
    return any(a < b for a, b in known) and all(a <= b for a, b in known)


def misfit(point: Point, budget: PlatformBudget, recorded_hz: float) -> str | None:
    """Return why a point does not fit a budget; None if it does, as far as its sizes are known."""
    rate_hz = budget.rate_hz
    if rate_hz is not None and rate_hz > 1.001 * recorded_hz and not point.any_rate:
        return f"whose features hold at {recorded_hz:g} Hz only"
    if budget.target in SOFT_DOUBLES and point.number == "float64":
        return f"whose doubles would run in software on a {budget.target}"
    tick_ns = point.tick_ns_p99 or point.tick_ns_hot
    for what, has, may in (
        ("us a tick", 1e-3 * tick_ns, budget.tick_us),
        ("bytes of flash", point.flash_bytes, budget.flash_bytes),
        ("bytes of RAM", point.ram_bytes, budget.ram_bytes),
        ("instructions a tick", point.instructions, budget.instructions),
    ):
        if may is not None and has is not None and has > may:
            return f"above {may:g} {what}"
    return None


def unmeasured(point: Point, budget: PlatformBudget) -> str | None:
    """Return which size of the budget is not known of a point, and why; None if all are."""
    if budget.flash_bytes is None or point.flash_bytes is not None:
        return None
    return f"flash could not be measured ({point.why})"


def pick(
    points: Sequence[Point],
    budget: PlatformBudget,
    recorded_hz: float,
    complete: Callable[[Point], Point],
) -> Point | None:
    """Pick the point of lowest cross-validated error that fits, is passive and bounded, or None.

    Passive: no cell of its small-signal map is active. `complete` returns the point with what is
    measured alone on the machine. Of points within half a per cent of that error, the fastest that
    is bounded too. Where none is bounded, the point of lowest error, which says so: some objects
    are too hard for a hand at their recordings' rate.
    """
    best: Point | None = None
    unbounded: list[Point] = []
    passive = [p for p in points if not p.active_cells and misfit(p, budget, recorded_hz) is None]
    for swept in sorted(passive, key=lambda p: p.cv_rmse_n):
        if best is not None and swept.cv_rmse_n > ERROR_TOLERANCE * best.cv_rmse_n:
            break
        if best is not None and swept.tick_ns_hot >= _FASTER * best.tick_ns_hot:
            continue
        point = complete(swept)
        if misfit(point, budget, recorded_hz) is not None:
            continue  # as its isolated measurement says
        if point.bounded:
            best = point
            continue
        unbounded.append(point)
        if best is None and len(unbounded) == MAX_TRIED:
            break
    return best or next(iter(unbounded), None)


def why(point: Point, points: Sequence[Point], budget: PlatformBudget, recorded_hz: float) -> str:
    """Explain a pick: its gain on the paper's forest, and why nothing more accurate was taken."""
    text = "lowest error on held-out training recordings of all that fit this budget"
    if not point.bounded:
        text = (
            f"{text} and are passive, for simulation only: no model that was tried is "
            f"bounded in every hand at {recorded_hz:g} Hz; record and render faster, or a softer "
            "object"
        )
        return text + _unjudged(point, budget)
    text += ", are passive and stay bounded with every hand"
    paper = next((p for p in points if p.model == "rf-fd" and not p.options), None)
    if paper is not None and paper.key != point.key:
        error, time = point.rmse_n / paper.rmse_n, point.tick_ns_hot / paper.tick_ns_hot
        text += f"; {error:.0%} of the error of the paper's forest in {time:.0%} of its time"
    reasons = Counter(
        _rejected(other, budget, recorded_hz)
        for other in points
        if other.cv_rmse_n < point.cv_rmse_n
    )
    if reasons:
        listed = ", ".join(f"{count} {reason}" for reason, count in sorted(reasons.items()))
        text += f". Of less error, but not taken: {listed}"
    return text + _unjudged(point, budget)


def _unjudged(point: Point, budget: PlatformBudget) -> str:
    unknown = unmeasured(point, budget)
    return "" if unknown is None else f". Its {unknown}, and did not decide"


def _rejected(other: Point, budget: PlatformBudget, recorded_hz: float) -> str:
    if (reason := misfit(other, budget, recorded_hz)) is not None:
        return reason
    if other.active_cells:
        return "with a non-passive cell"
    if other.bounded is False:
        return "not bounded in the closed loop"
    return "better by half a per cent at most, and slower or no faster"
