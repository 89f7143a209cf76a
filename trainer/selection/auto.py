"""Kind `auto`: the passive model, unless trees on top of it lower the held-out error for certain.

The validation data is never seen.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Model
from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.hybrid import (
    HYBRID_LEAF,
    HYBRID_TREES,
    derivative_features,
    lag_features,
)
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.cross_validation import TreeFit, folded_rows
from springpot.trainer.selection.scores import PASSIVE, AutoCandidate, Score, find_scores
from springpot.trainer.selection.small_signal import active_cells

GAIN, GAIN_OF_ONE = 0.05, 0.10  # of the error, that trees have to take off; with one recording
FORCE_TOLERANCE = 5e-4  # of the maximum force: below what a sensor or a hand resolves
_SHARES = (0.75, 0.5)  # of the trees' force, where all of it gives energy


def fit_auto(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the best candidate on all training recordings.

    Its metadata has the table of scores, and in words why it was chosen. Of trees that give energy
    in small motions a share is taken that does not; if there is none, they are passed over.
    """
    begin = time.perf_counter()
    known = candidates(data, options)
    scores = find_scores(known, folded_rows(data, options))
    gain = GAIN if len(data.recordings) > 1 else GAIN_OF_ONE
    peak_n = max(abs(data.trained.max_n), abs(data.trained.min_n))
    active: dict[str, int] = {}
    for chosen in ranked(scores, gain, peak_n):
        candidate = next(some for some in known if some.name == chosen.name)
        search_s = time.perf_counter() - begin
        fit = fit_kind(candidate.kind, name, data, candidate.options)
        model, share, cells = _quiet(fit.model)
        if cells == 0:
            fit = replace(fit, model=model)
            break
        active[chosen.name] = cells
    metadata = {
        **fit.metadata,
        "chosen": chosen.name,
        "scores": [vars(score) for score in scores],
        "why": reason(chosen, scores, gain, peak_n, active) + _shared(share),
        "share_of_trees": share,
    }
    return replace(fit, search_s=search_s, metadata=metadata)


def ranked(scores: Sequence[Score], gain: float, peak_n: float) -> list[Score]:
    """Those that may be chosen, the best first; the passive model is the last of them.

    Trees may where they take `gain` off the passive error, more than is felt, and do so without
    their best fold too. Of two whose difference is not felt the cheaper comes first.
    """
    passive = next(score for score in scores if score.name == PASSIVE)
    felt_n = FORCE_TOLERANCE * peak_n
    worth = [
        score
        for score in scores
        if score is not passive
        and max(score.ratio, score.ratio_without_best) <= 1.0 - gain
        and score.mean_n < passive.mean_n - felt_n
    ]
    minimum_n = min((score.mean_n for score in worth), default=0.0)
    worth.sort(key=lambda score: (score.mean_n > minimum_n + felt_n, score.cost, score.mean_n))
    return [*worth, passive]


def reason(
    chosen: Score, scores: Sequence[Score], gain: float, peak_n: float, active: dict[str, int]
) -> str:
    """In words: what the winner has over the next one."""
    others = [score for score in scores if score is not chosen]
    nearest = min(others, key=lambda score: score.ratio)
    passed = "".join(
        f"; {name} gives energy in {cells} of its small motions" for name, cells in active.items()
    )
    if chosen.name != PASSIVE:
        passive = next(score for score in scores if score.name == PASSIVE)
        return (
            f"{_percent(chosen.ratio)} than the passive model alone "
            f"({_share(chosen, peak_n)} of peak for {_share(passive, peak_n)}), in {chosen.folds} "
            f"folds; the next, {nearest.name}, has {_percent(nearest.ratio / chosen.ratio)}{passed}"
        )
    but = ""
    if nearest.ratio <= 1.0 - gain and nearest.name not in active:
        felt = nearest.mean_n < chosen.mean_n - FORCE_TOLERANCE * peak_n
        but = ", most of it in one fold" if felt else (
            f", {_share(nearest, peak_n)} of peak for {_share(chosen, peak_n)}: nobody feels that"
        )  # fmt: skip
    return (
        f"passive by itself; the next, {nearest.name}, has {_percent(nearest.ratio)}{but} (trees "
        f"are taken for {100 * gain:.0f} % less, if a hand could feel it){passed}"
    )


def candidates(data: TrainingSet, options: FitOptions) -> list[AutoCandidate]:
    """The passive model, trees on what it leaves over, and the paper's forest with a long memory.

    The paper's other models were the best on none of the judges (tests/bench/judges.py).
    """
    long = replace(options, engine="recursive", window_s=data.longest_s)
    remembering = derivative_features(data)

    def on_top(features: Features) -> TreeFit:
        return TreeFit(features, HYBRID_TREES, HYBRID_LEAF, adds=True)

    alone = TreeFit(remembering, options.trees, options.leaf, adds=False)
    return [
        AutoCandidate(PASSIVE, 1, "hammerstein", options, None),
        AutoCandidate("hybrid lags", 4, "hybrid", options, on_top(lag_features(data))),
        AutoCandidate("hybrid derivatives", 4, "hybrid", long, on_top(remembering)),
        AutoCandidate("rf-fd long", 6, "rf-fd", long, alone),
    ]


def _quiet(model: Model) -> tuple[Model, float, int]:
    """The model with the largest share of its trees that has no active cell, the share, and cells.

    The share is 0 of a model without trees.
    What trees add on top of the passive model may be any share of them; a forest alone may not.
    """
    if model.regressor is None:
        return model, 0.0, 0
    all_cells = active_cells(model)
    if all_cells and model.hammerstein_adds:
        for share in _SHARES:
            quieter = replace(
                model,
                regressor=model.regressor.share(share),
                provenance={**model.provenance, "share_of_trees": share},
            )
            if active_cells(quieter) == 0:
                return quieter, share, 0
    return model, 1.0, all_cells


def _percent(ratio: float) -> str:
    """An error's ratio to another's, in words."""
    change = 100 * abs(ratio - 1.0)
    return f"{change:.0f} % {'less' if ratio < 1.0 else 'more'} error"


def _shared(share: float) -> str:
    if share in (0.0, 1.0):
        return ""
    return f"; {share:g} of the trees' force is added, more of it gives energy in small motions"


def _share(score: Score, peak_n: float) -> str:
    return f"{100 * score.mean_n / peak_n:.2g} %"
