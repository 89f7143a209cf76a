"""Kind `auto`: the passive model, unless a forest lowers the held-out error for certain.

The validation data is never seen.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from springpot.trainer.features import recursive_bank
from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.passive.start import with_start
from springpot.trainer.models.rf_fd import PAPER_ORDERS
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.cross_validation import folded_rows
from springpot.trainer.selection.scores import PASSIVE, AutoCandidate, Score, find_scores
from springpot.trainer.selection.small_signal import active_cells

GAIN, GAIN_OF_ONE = 0.05, 0.10  # of the error, that trees have to take off; with one recording
FORCE_TOLERANCE = 5e-4  # of the maximum force: below what a sensor or a hand resolves


def fit_auto(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the best candidate on all training recordings.

    Its metadata has the table of scores, and in words why it was chosen. A forest that gives energy
    in small motions is passed over.
    """
    begin = time.perf_counter()
    data = with_start(data, options)
    known = candidates(data, options)
    scores = find_scores(known, folded_rows(data, options))
    gain = GAIN if len(data.recordings) > 1 else GAIN_OF_ONE
    peak_n = max(abs(data.trained.max_n), abs(data.trained.min_n))
    active: dict[str, int] = {}
    for chosen in ranked(scores, gain, peak_n):
        candidate = next(some for some in known if some.name == chosen.name)
        search_s = time.perf_counter() - begin
        fit = fit_kind(candidate.kind, name, data, candidate.options)
        cells = 0 if chosen.name == PASSIVE else active_cells(fit.model)
        if cells == 0:
            break
        active[chosen.name] = cells
    metadata = {
        **fit.metadata,
        "chosen": chosen.name,
        "scores": [vars(score) for score in scores],
        "why": reason(chosen, scores, gain, peak_n, active),
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
    """The passive model, and the paper's forest with a memory as long as the recordings."""
    long = replace(options, engine="recursive", window_s=data.longest_s)
    remembering = recursive_bank(PAPER_ORDERS, data.dt_s, data.longest_s)
    return [
        AutoCandidate(PASSIVE, 1, "hammerstein", options, None),
        AutoCandidate("rf-fd long", 6, "rf-fd", long, remembering),
    ]


def _percent(ratio: float) -> str:
    """An error's ratio to another's, in words."""
    change = 100 * abs(ratio - 1.0)
    return f"{change:.0f} % {'less' if ratio < 1.0 else 'more'} error"


def _share(score: Score, peak_n: float) -> str:
    return f"{100 * score.mean_n / peak_n:.2g} %"
