"""Smaller forests out of a fitted one."""

from dataclasses import replace

import numpy as np
from support.c.same_bits import require_same_bits
from support.small import press, scene, small_model, training

from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.forest import keep_trees, merge_leaves, quantise_thresholds
from springpot.codegen.model.regressors import Forest
from springpot.trainer.features import feature_values
from springpot.trainer.models.depths import compute_depth_m
from springpot.trainer.models.predict import regressor_force


def forest() -> Forest:
    return small_model().regressor


def features() -> np.ndarray:
    model, item = small_model(), training()[-1]
    rows = np.arange(len(item.force_n))
    return feature_values(model.features, compute_depth_m(item, "surface"), item.dt_s, rows)


def test_fewer_trees_are_the_mean_of_those_that_stay() -> None:
    values = features()
    each = [regressor_force(keep_trees(forest(), 1), values)]
    for count in (2, 3, 5):
        whole = regressor_force(keep_trees(forest(), count), values)
        before = regressor_force(keep_trees(forest(), count - 1), values)
        each.append(count * whole - (count - 1) * before)
        assert np.all((each[-1] > -1e-3) & (each[-1] < 10.0))
    np.testing.assert_allclose(
        regressor_force(keep_trees(forest(), 5), values),
        regressor_force(forest(), values),
        atol=1e-3,
    )
    assert len(keep_trees(forest(), 2).feature) < len(forest().feature)
    assert keep_trees(replace(forest(), weight=0.1), 2).weight == 0.1  # a sum, as of boosting


def test_larger_leaves_are_the_mean_of_what_they_replace() -> None:
    pruned = merge_leaves(forest(), 4)
    assert len(pruned.feature) < 0.6 * len(forest().feature)
    leaf = pruned.feature < 0
    assert pruned.value_n[leaf].min() >= forest().value_n[forest().feature < 0].min()
    values = features()
    whole, smaller = regressor_force(forest(), values), regressor_force(pruned, values)
    assert 0 < np.sqrt(np.mean((whole - smaller) ** 2)) < 0.05 * np.ptp(whole)
    same = merge_leaves(forest(), 1)
    np.testing.assert_allclose(regressor_force(same, values), whole, atol=1e-3)
    one = merge_leaves(forest(), 10**9)
    assert len(one.feature) == len(one.roots) == len(forest().roots)


def test_stepped_thresholds_are_in_the_c_what_they_are_in_numpy() -> None:
    model = small_model()
    steps = replace(model, regressor=quantise_thresholds(forest(), model.features.n_features))
    require_same_bits(make_plan(steps, scene(mode="off"), accept_unsafe=True), 1.2 * press(2.0))


def test_stepped_thresholds_decide_nearly_alike() -> None:
    values = features()
    steps = quantise_thresholds(forest(), small_model().features.n_features)
    assert steps.quantisation is not None
    off_n = np.abs(regressor_force(steps, values) - regressor_force(forest(), values))
    assert off_n.mean() < 2e-3 and np.mean(off_n > 0.0) < 0.2
    for far in (values + 10.0, -values - 10.0):  # beyond every threshold, clipped to a last step
        both = (regressor_force(its, far) for its in (steps, forest()))
        np.testing.assert_allclose(*both, atol=1e-3)
