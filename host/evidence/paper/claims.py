"""The paper's claims beside what was found here, and whether each holds."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from springpot.codegen.arrays import rms
from springpot.host.evidence.paper.reproduce import PAPER_KINDS, ObjectResult, by_softness
from springpot.host.evidence.paper.sampling import STEPS_S, Resampled, relative_change
from springpot.host.metrics import WEBER_FRACTION

PAPER_DEPTHS_MM = {
    "ecoflex-00-10": 17.7,
    "ecoflex-00-30": 14.5,
    "ecoflex-00-50": 10.4,
    "dragon-skin-fx": 7.5,
    "dragon-skin-10": 7.1,
}
PAPER_MODELLING_S = {"rf-fd": 11.9, "rbf-fd": 126.7, "rbf-pv": 126.7}  # figure 10
PAPER_RATES_HZ = {"rf-fd": 788.3, "rbf-fd": 990.3, "rbf-pv": 1982.6}  # table 3, means
DEPTH_TOLERANCE = 0.05
MIN_BELOW_JND = 0.99
SIMILAR_RATIO = 1.25  # maximum ratio of two errors that are "very similar"
_HALF = 0.5
_TIED = 1.05  # times a tick: what is nearer is not told apart


@dataclass(frozen=True)
class Claim:
    """What the paper says, what was found, and whether it holds (None: cannot be checked here)."""

    claim: str
    paper: str
    here: str
    holds: bool | None

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def check_claims(results: Sequence[ObjectResult], sampled: Resampled) -> list[Claim]:
    """Check all claims that these objects support; each result needs the paper's three kinds."""
    results = by_softness(results)
    return [
        *_depths(results),
        *_errors(results),
        _percentage_errors(results),
        _percentage_order(results),
        *_modelling(results),
        _rates(results),
        _resampling(sampled),
        *_sampling(),
    ]


def _depths(results: Sequence[ObjectResult]) -> list[Claim]:
    known = [result for result in results if result.data.name in PAPER_DEPTHS_MM]
    if not known:
        return []
    paper = [PAPER_DEPTHS_MM[result.data.name] for result in known]
    here = [1e3 * result.data.depth_m for result in known]
    near = np.abs(np.divide(here, paper) - 1.0) < DEPTH_TOLERANCE
    return [
        Claim(
            "maximum depths at 10 N (table 1; the simulation is scaled to them), within 5 %",
            ", ".join(f"{depth:g}" for depth in paper) + " mm",
            ", ".join(f"{depth:.1f}" for depth in here) + " mm",
            bool(near.all()),
        )
    ]


def _errors(results: Sequence[ObjectResult]) -> list[Claim]:
    claims = []
    for kind in ("rf-fd", "rbf-fd"):
        ratios = [result.rmse_n(kind) / result.rmse_n("rbf-pv") for result in results]
        here = f"{kind} / rbf-pv {each_object(results, ratios)}"
        lower = max(ratios) < 1.0
        claims.append(Claim(f"{kind}: RMSE below rbf-pv for every object", "fig. 9", here, lower))
    ratios = [result.rmse_n("rf-fd") / result.rmse_n("rbf-fd") for result in results]
    similar = all(1.0 / SIMILAR_RATIO <= ratio <= SIMILAR_RATIO for ratio in ratios)
    here = f"rf-fd / rbf-fd {each_object(results, ratios)}"
    claims.append(
        Claim(f"rf-fd and rbf-fd: RMSE within {SIMILAR_RATIO:g} x", "fig. 9", here, similar)
    )
    worst = [max(_p99(result, kind) for kind in PAPER_KINDS) for result in results]
    here = f"99 % of samples below {each_object(results, worst)} N, worst of the three models"
    if len(results) > 1:
        text = "absolute errors below 0.4 N but for the softest object"
        claims.append(Claim(text, "fig. 7", here, max(worst[1:]) < 0.4))
    text = "absolute errors of the softest object around 1 N at most"
    claims.append(Claim(text, "fig. 7", f"99 % of samples below {worst[0]:.2f} N", worst[0] < 1.1))
    return claims


def _percentage_errors(results: Sequence[ObjectResult]) -> Claim:
    minimum = {kind: min(_below_jnd(result, kind) for result in results) for kind in PAPER_KINDS}
    here = ", ".join(f"{kind} {100 * share:.1f} %" for kind, share in minimum.items())
    return Claim(
        "percentage errors below the just noticeable difference above 2 N, all models and "
        f"objects ({100 * MIN_BELOW_JND:g} % of samples)",
        "fig. 8",
        f"share of samples below it, worst object: {here}",
        min(minimum.values()) >= MIN_BELOW_JND,
    )


def _percentage_order(results: Sequence[ObjectResult]) -> Claim:
    shares = [
        (min(_below_jnd(r, "rf-fd"), _below_jnd(r, "rbf-fd")), _below_jnd(r, "rbf-pv"))
        for r in results
    ]
    here = ", ".join(
        f"{r.data.name} {100 * fd:.1f} against {100 * pv:.1f} %"
        for r, (fd, pv) in zip(results, shares, strict=True)
    )
    return Claim(
        "both models on fractional derivatives have lower percentage errors than rbf-pv",
        "fig. 8",
        f"share below the just noticeable difference: {here}",
        all(fd > pv for fd, pv in shares),
    )


def _modelling(results: Sequence[ObjectResult]) -> list[Claim]:
    mean = {
        kind: float(np.mean([r.models[kind].modelling_s for r in results])) for kind in PAPER_KINDS
    }
    search_s = float(np.mean([r.models["rbf-fd"].fit.search_s for r in results]))
    here = ", ".join(f"{kind} {seconds:.2f} s" for kind, seconds in mean.items())
    return [
        Claim(
            "modelling (features and training) with rf-fd at least ten times cheaper than rbf",
            "11.9 s against 126.7 s (fig. 10)",
            f"{here}; a plain least-squares RBF is cheap: the ratio is that of the paper's RBF "
            f"software. The search of the pair of orders takes {search_s:.2f} s more",
            min(mean["rbf-fd"], mean["rbf-pv"]) >= 10.0 * mean["rf-fd"],
        )
    ]


def _rates(results: Sequence[ObjectResult]) -> Claim:
    ticks = {
        kind: float(np.mean([r.models[kind].validation.ticks.hot_median for r in results]))
        for kind in PAPER_KINDS
    }
    here = ", ".join(f"{kind} {1e9 / tick:.3g} Hz" for kind, tick in ticks.items())
    pairs = (("rf-fd", "rbf-fd"), ("rbf-fd", "rbf-pv"))
    ratios = [ticks[slower] / ticks[faster] for slower, faster in pairs]
    holds: bool | None = all(ratio > 1.0 for ratio in ratios)
    if min(ratios) > 1.0 / _TIED and not all(ratio > _TIED for ratio in ratios):
        here, holds = f"{here}: two are within 5 %, which a busy machine decides", None
    return Claim(
        "update rates: rf-fd below rbf-fd below rbf-pv",
        "788, 990, 1983 Hz (table 3)",
        f"{here} (hot ticks, one thread)",
        holds,
    )


def _resampling(sampled: Resampled) -> Claim:
    change = rms(sampled.difference_n) / rms(sampled.force_n)
    return Claim(
        "rf-fd sampled every 1.27 ms gives the force of 1 ms (fig. 14), within 10 %",
        "very similar curves",
        f"RMS difference {100 * change:.1f} % of the force, maximum "
        f"{np.abs(sampled.difference_n).max():.2f} N",
        change < WEBER_FRACTION,
    )


def _sampling() -> list[Claim]:
    orders = np.round(np.arange(1, 21) * 0.05, 2)
    steps = [step for step in STEPS_S if step != STEPS_S[1]]
    fixed = np.array([[relative_change(o, s, own_taps=False) for s in steps] for o in orders])
    own = np.array([[relative_change(o, s, own_taps=True) for s in steps] for o in orders])
    half = float(fixed[orders <= _HALF].max())
    grows = bool(np.all(np.diff(fixed.max(axis=1)) > 0.0))
    peak = float(orders[int(own.max(axis=1).argmax())])
    return [
        Claim(
            "derivatives at 0.8 and 1.2 ms are close to those at 1 ms for orders up to 0.5, "
            "within 10 %",
            "very similar (fig. 20)",
            f"RMS change at most {100 * half:.1f} % with the taps of 1 ms",
            half < WEBER_FRACTION,
        ),
        Claim(
            "and the differences grow as the order rises to 1",
            "fig. 20",
            f"{100 * float(fixed[-1].max()):.0f} % at order 1 with the taps of 1 ms; with taps "
            f"of the step itself maximum at order {peak:g} and none at 1",
            grows,
        ),
    ]


def _p99(result: ObjectResult, kind: str) -> float:
    return result.models[kind].validation.accuracy.p99_abs_error_n


def _below_jnd(result: ObjectResult, kind: str) -> float:
    share = result.models[kind].validation.accuracy.ape_below_jnd
    return 1.0 if share is None else share


def each_object(results: Sequence[ObjectResult], values: Sequence[float], digits: int = 2) -> str:
    """Return a value of each object, by name."""
    pairs = zip(results, values, strict=True)
    return ", ".join(f"{result.data.name} {value:.{digits}f}" for result, value in pairs)
