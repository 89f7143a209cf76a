"""The Pareto front of a benchmark, and the point to pick for each budget."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

Facts = dict[str, Any]
NEARLY = 1.005  # of the least error: of two within it, the faster is taken
PERIOD_SHARE = 0.1  # of the period that a tick may take on a PC, that does other work too
_AXES = ("cv_rmse_n", "tick_ns_hot", "flash_bytes")


@dataclass(frozen=True)
class Budget:
    """What a device has to spare; None is no limit.

    tick_us: on this machine. instructions: of a tick on the target, judged where they are counted.
    rate_hz: of the loop; None: any, the recordings' own.
    """

    name: str
    title: str
    rate_hz: float | None = None
    tick_us: float | None = None
    flash_bytes: int | None = None
    ram_bytes: int | None = None
    instructions: int | None = None

    def as_dict(self) -> Facts:
        """JSON values."""
        return asdict(self)


def pc_budget(rate_hz: float) -> Budget:
    """A tenth of a period."""
    khz = f"{rate_hz / 1e3:g}"
    return Budget(
        f"pc-{khz}khz", f"PC at {khz} kHz", rate_hz=rate_hz, tick_us=1e6 * PERIOD_SHARE / rate_hz
    )


def board_budget(target: str) -> Budget:
    """A microcontroller of 256 kB of flash whose loop spares 8 000 instructions a tick."""
    return Budget(
        target,
        f"board with a {target}",
        flash_bytes=256 * 1024,
        ram_bytes=64 * 1024,
        instructions=8000,
    )


def budgets(target: str) -> tuple[Budget, ...]:
    """A PC at 1 and at 4 kHz, and the board."""
    boards = () if target == "host" else (board_budget(target),)
    return (pc_budget(1000.0), pc_budget(4000.0), *boards)


def pareto(points: Sequence[Facts]) -> set[str]:
    """Keys of the points that no other beats in error, time and flash alike.

    The error is the cross-validated one: the validation recordings only report.
    """
    rows = {p["key"]: tuple(p[axis] or 0 for axis in _AXES) for p in points}
    return {key for key, row in rows.items() if not any(_beats(o, row) for o in rows.values())}


def _beats(one: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    return one != other and all(a <= b for a, b in zip(one, other, strict=True))


def misfit(point: Facts, budget: Budget, recorded_hz: float) -> str | None:
    """Why a point does not fit a budget; None where it does."""
    rate_hz = budget.rate_hz
    if rate_hz is not None and rate_hz > 1.001 * recorded_hz and not point["any_rate"]:
        return f"its features hold at {recorded_hz:g} Hz only"
    tick_ns = point.get("tick_ns_p999") or point["tick_ns_hot"]
    for what, has, may in (
        ("us a tick", 1e-3 * tick_ns, budget.tick_us),
        ("bytes of flash", point["flash_bytes"], budget.flash_bytes),
        ("bytes of RAM", point["ram_bytes"], budget.ram_bytes),
        ("instructions a tick", point.get("instructions"), budget.instructions),
    ):
        if may is not None and has is not None and has > may:
            return f"{has:.4g} {what}, the budget is {may:g}"
        if may is not None and has is None and what == "bytes of flash":
            return "its flash is unknown: no compiler for the target"
    return None


def pick(
    points: Sequence[Facts],
    budget: Budget,
    recorded_hz: float,
    is_bounded: Callable[[Facts], bool],
) -> Facts | None:
    """The point of least cross-validated error that fits, is passive and bounded; None: none is.

    Passive: no cell of its small-signal map is active. `is_bounded` runs the closed loop, and
    completes the point with what is measured alone on the machine. Of points within half a per
    cent of that error, the fastest that is bounded too.
    """
    best: Facts | None = None
    for point in _candidates(points, budget, recorded_hz):
        if best is not None and point["cv_rmse_n"] > NEARLY * best["cv_rmse_n"]:
            break
        if best is not None and point["tick_ns_hot"] >= best["tick_ns_hot"]:
            continue
        if is_bounded(point) and misfit(point, budget, recorded_hz) is None:
            best = point
    return best


def _candidates(points: Sequence[Facts], budget: Budget, recorded_hz: float) -> Iterator[Facts]:
    fitting = [p for p in points if misfit(p, budget, recorded_hz) is None]
    yield from sorted((p for p in fitting if not p["active_cells"]), key=lambda p: p["cv_rmse_n"])


def why(point: Facts, points: Sequence[Facts], budget: Budget, recorded_hz: float) -> str:
    """One sentence on what was chosen, and on the more accurate points that were not."""
    better = [p for p in points if p["cv_rmse_n"] < point["cv_rmse_n"] and p is not point]
    reasons: dict[str, int] = {}
    for other in better:
        reason = _rejected(other, budget, recorded_hz)
        reasons[reason] = reasons.get(reason, 0) + 1
    text = (
        "the least error on held-out training recordings among the points that fit this budget, "
        "give no energy back and stay bounded with every hand"
    )
    if reasons:
        listed = ", ".join(f"{count} {reason}" for reason, count in sorted(reasons.items()))
        text += f"; of {len(better)} with less error, {listed}"
    return text


def _rejected(other: Facts, budget: Budget, recorded_hz: float) -> str:
    if misfit(other, budget, recorded_hz) is not None:
        return "do not fit"
    if other["active_cells"]:
        return "give energy back"
    if other.get("bounded") is False:
        return "are not bounded in the closed loop"
    return "are slower, and better by half a per cent at most"
