"""Long work says how far it is, on the line that turns."""

import logging

from springpot.host.console.output import spinner


def test_the_spinner_says_which_candidate_is_fitted() -> None:
    auto = logging.getLogger("springpot.trainer.selection.auto")
    with spinner("fitting auto on 4 recordings") as status:
        auto.info("%d of %d: %s", 3, 7, "rf-fd")
        assert str(status.status) == "fitting auto on 4 recordings, 3 of 7: rf-fd"
    auto.info("%d of %d: %s", 4, 7, "boosted")
    assert str(status.status).endswith("3 of 7: rf-fd")
