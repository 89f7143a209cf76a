"""`--within`: smaller forests that keep the error."""

import pytest
from support.small import training

from springpot.codegen.errors import UsageError
from springpot.host.wings.smaller.forest_search import reduced_options
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.training_set import training_set

OPTIONS = FitOptions(trees=20, leaf=5)


def test_the_chosen_size_is_the_smallest_within_the_loss() -> None:
    data = training_set(training(), OPTIONS.smooth_s)
    search = reduced_options(data, OPTIONS, 0.05, ())
    allowed = 1.05 * search.asked.rmse_n
    assert (search.asked.trees, search.asked.leaf) == (20, 5)
    assert search.chosen.rmse_n <= allowed
    assert search.chosen.nodes < search.asked.nodes
    smaller = [size for size in search.tried if size.nodes < search.chosen.nodes]
    assert smaller and all(size.rmse_n > allowed for size in smaller)
    assert len({size.leaf for size in search.tried}) > 3
    assert len({len(size.orders) for size in search.tried}) > 3


def test_no_loss_keeps_the_error_that_was_asked_for() -> None:
    data = training_set(training(), OPTIONS.smooth_s)
    search = reduced_options(data, OPTIONS, 0.0, ())
    assert search.chosen.rmse_n <= search.asked.rmse_n


def test_the_papers_way_needs_recordings_to_judge_on() -> None:
    options = FitOptions(within=0.1, select="paper")
    with pytest.raises(UsageError, match="--select paper needs validation recordings"):
        fit_model("rf-fd", "x", training(), options)


def test_other_kinds_have_no_trees_to_leave_out() -> None:
    with pytest.raises(UsageError, match="--within reduces rf-fd; hammerstein"):
        fit_model("hammerstein", "x", training(), FitOptions(within=0.1))
