"""What the paper says of the orders that models choose: figure 11, table 2."""

from collections.abc import Sequence

import numpy as np

from springpot.host.evidence.paper.claims import Claim, each_object
from springpot.host.evidence.paper.reproduce import ObjectResult, by_softness

PAPER_PAIRS = {  # table 2: orders that rbf-fd chose
    "ecoflex-00-10": (0.30, 0.35),
    "ecoflex-00-30": (0.15, 0.20),
    "ecoflex-00-50": (0.10, 0.15),
    "dragon-skin-fx": (0.10, 0.15),
    "dragon-skin-10": (0.10, 0.15),
}
_LOW_ORDER, _MEDIUM_ORDER = 0.4, 0.3
_ONE_STEP = 0.051  # of the orders


def check_orders(results: Sequence[ObjectResult]) -> list[Claim]:
    """Return the claims of its figure 11 and table 2."""
    results = by_softness(results)
    return [*_importances(results), *_pairs(results)]


def _importances(results: Sequence[ObjectResult]) -> list[Claim]:
    middle, low, medium = [], [], []
    for result in results:
        fit = result.models["rf-fd"].fit
        orders = np.array(fit.model.features.orders)  # type: ignore[union-attr]
        shares = np.array(fit.metadata["importance"])
        middle.append(float(orders @ shares))
        low.append(float(shares[orders <= _LOW_ORDER].sum()))
        medium.append(float(shares[orders > _MEDIUM_ORDER - _ONE_STEP / 2].sum()))
    claims = [
        Claim(
            "orders of high importance in rf-fd are below 0.4",
            "fig. 11, section V",
            f"share of the importance at or below 0.4: {each_object(results, low)}",
            min(low) > 0.5,
        )
    ]
    if len(results) > 1:
        text = "importances shift to higher orders for softer objects"
        falls = bool(np.all(np.diff(middle) <= 0.0))
        here = f"mean order, softest first: {each_object(results, middle, 3)}"
        claims.append(Claim(text, "fig. 11", here, falls))
        text = (
            "medium orders (0.3 to 0.5) are more important for the softest object, low ones for "
            "the hardest: above and below half of the importance"
        )
        here = f"share of 0.3 to 0.5, softest first: {each_object(results, medium, 3)}"
        claims.append(Claim(text, "section IV-C, fig. 11", here, medium[0] > 0.5 > medium[-1]))
    return claims


def _pairs(results: Sequence[ObjectResult]) -> list[Claim]:
    known = [result for result in results if result.data.name in PAPER_PAIRS]
    if not known:
        return []
    paper = [PAPER_PAIRS[result.data.name] for result in known]
    here = [result.models["rbf-fd"].fit.model.orders for result in known]
    near = np.abs(np.subtract(here, paper)) < _ONE_STEP
    words = [" and ".join(f"{order:.2f}" for order in pair) for pair in here]
    return [
        Claim(
            "the two orders that rbf-fd chooses (here cross-validated), within one step of 0.05",
            "; ".join(f"{first:.2f} and {second:.2f}" for first, second in paper) + " (table 2)",
            "; ".join(f"{r.data.name} {text}" for r, text in zip(known, words, strict=True)),
            bool(near.all()),
        )
    ]
