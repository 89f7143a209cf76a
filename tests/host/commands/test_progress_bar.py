"""Long work says how far it is, beside a bar that has an end."""

import logging

from springpot.host.console.output import progress_bar


def test_the_bar_says_which_candidate_is_fitted_and_how_much_is_left() -> None:
    auto = logging.getLogger("springpot.trainer.selection.auto")
    with progress_bar("fitting auto on 4 recordings") as progress:
        (task,) = progress.tasks
        assert task.total is None
        auto.info("3 of 4: rf-fd", extra={"done": 9, "total": 12})
        assert task.description == "fitting auto on 4 recordings, 3 of 4: rf-fd"
        assert (task.completed, task.total) == (9, 12)
    auto.info("4 of 4: boosted", extra={"done": 12, "total": 12})
    assert task.completed == 9
