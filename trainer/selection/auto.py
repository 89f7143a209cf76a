"""Kind `auto`: the passive model, unless a forest lowers the held-out error for certain.

The validation data is never seen.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

from springpot.trainer.features import MAX_TAU_PER_MEMORY, fit_recursive_bank
from springpot.trainer.kinds import fit_kind
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.passive.start import select_start
from springpot.trainer.models.rf_fd import PAPER_ORDERS
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.scores import FOREST, PASSIVE, Score, find_scores
from springpot.trainer.selection.small_signal import count_active_cells

GAIN, GAIN_OF_ONE = 0.05, 0.10  # of the error, that trees have to take off; with one recording
FORCE_TOLERANCE = 5e-4  # of the maximum force: below what a sensor or a hand resolves


def fit_auto(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Fit the passive model, or the paper's forest on exponentials as slow as the recordings last.

    Its metadata has the table of scores, and in words why it was chosen. A forest that gives energy
    in small motions is passed over.
    """
    begin = time.perf_counter()
    data = select_start(data, options)
    # What lasts longer than a recording tells the time in it: folds within it inherit its history,
    # and cannot see that.
    window_s = data.longest_s / MAX_TAU_PER_MEMORY
    forest_options = replace(options, engine="recursive", window_s=window_s)
    features = fit_recursive_bank(PAPER_ORDERS, data.dt_s, window_s)
    passive, forest = find_scores(data, options, forest_options, features)
    gain = GAIN if len(data.recordings) > 1 else GAIN_OF_ONE
    peak_n = max(abs(data.trained.max_n), abs(data.trained.min_n))
    chosen, cells = passive, 0
    search_s = time.perf_counter() - begin
    if forest_wins(passive, forest, gain, peak_n):
        fit = fit_kind("rf-fd", name, data, forest_options)
        cells = count_active_cells(fit.model)
        chosen = passive if cells else forest
    if chosen is passive:
        search_s = time.perf_counter() - begin
        fit = fit_kind(PASSIVE, name, data, options)
    metadata = {
        "cv_rmse_n": chosen.mean_n,  # of a forest; the passive fit has its own
        **fit.metadata,
        "chosen": chosen.name,
        "scores": [vars(score) for score in (passive, forest)],
        "why": explain_choice(passive, forest, gain, peak_n, cells),
    }
    return replace(fit, search_s=search_s, metadata=metadata)


def forest_wins(passive: Score, forest: Score, gain: float, peak_n: float) -> bool:
    """Tell if the forest takes `gain` off the passive error, without its best fold too, and felt.

    Felt: by more than a hand resolves.
    """
    felt = forest.mean_n < passive.mean_n - FORCE_TOLERANCE * peak_n
    return felt and max(forest.ratio, forest.ratio_without_best) <= 1.0 - gain


def explain_choice(passive: Score, forest: Score, gain: float, peak_n: float, cells: int) -> str:
    """Say what the winner has over the other; cells: small motions that a forest drives."""
    comparison = (
        f"{100 * abs(forest.ratio - 1.0):.0f} % {'less' if forest.ratio < 1.0 else 'more'} error"
    )
    forest_error, passive_error = (
        f"{100 * score.mean_n / peak_n:.2g} %" for score in (forest, passive)
    )
    shares = f"{forest_error} of peak for {passive_error}"
    if cells:
        objection = f"; {FOREST} gives energy in {cells} of its small motions"
    elif forest_wins(passive, forest, gain, peak_n):
        return f"{comparison} than the passive model alone ({shares}), in {forest.folds} folds"
    elif forest.ratio > 1.0 - gain:
        objection = ""
    else:
        is_felt = forest.mean_n < passive.mean_n - FORCE_TOLERANCE * peak_n
        objection = ", most of it in one fold" if is_felt else f", {shares}: nobody feels that"
    return (
        f"passive by itself; {FOREST} has {comparison}{objection} "
        f"(trees are taken for {100 * gain:.0f} % less, if a hand could feel it)"
    )
