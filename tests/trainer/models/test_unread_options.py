"""Options that a kind of model has no use for are said, and no others."""

from dataclasses import fields, replace

import pytest
from support.small import training

from springpot.codegen.model.model_file import model_hash
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions, WatchedOptions

SMALL = FitOptions(trees=4, leaf=30, n_centers=12)
OTHER = {
    "trees": 5, "leaf": 40, "n_centers": 13, "centers": "greedy", "monotone": True, "poles": 3,
    "round_features": True, "orders": (0.2, 0.4), "engine": "fir-fast",
}  # fmt: skip
KINDS = ("rf-fd", "rbf-fd", "rbf-pv", "rf-history", "hammerstein", "boosted")
SAID = "changes nothing"


@pytest.mark.parametrize("kind", KINDS)
def test_an_option_that_is_said_to_change_nothing_changes_nothing(kind: str) -> None:
    """All of them at once against each default: a model of the same bytes."""
    options = replace(SMALL, **OTHER)
    fit = fit_model(kind, "x", training()[:4], options)
    said = {line.partition(":")[0] for line in fit.warnings if SAID in line}
    assert said <= {field.name for field in fields(FitOptions)}
    defaults = {name: getattr(FitOptions(), name) for name in said}
    plain = fit_model(kind, "x", training()[:4], replace(options, **defaults))
    assert not [line for line in plain.warnings if SAID in line]
    assert model_hash(plain.model) == model_hash(fit.model)
    assert ("trees" in said) == (kind not in ("rf-fd", "rf-history", "boosted"))
    assert ("n_centers" in said) == (kind not in ("rbf-fd", "rbf-pv"))


@pytest.mark.parametrize("kind", ["auto", "hybrid"])
def test_kinds_that_choose_options_of_their_own_are_fitted(kind: str) -> None:
    """With `dataclasses.replace`, which reads them all."""
    fit = fit_model(kind, "x", training()[:3], SMALL)
    assert kind == "hybrid" or not [line for line in fit.warnings if SAID in line]


def test_watched_options_are_options() -> None:
    watched = WatchedOptions.of(SMALL)
    assert watched.unread() == ["trees", "leaf", "n_centers"]
    assert watched.trees == 4
    assert watched.unread() == ["leaf", "n_centers"]
    assert FitOptions(**{f.name: getattr(watched, f.name) for f in fields(FitOptions)}) == SMALL
