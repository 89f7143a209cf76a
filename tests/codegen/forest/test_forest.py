"""The C forests reach the leaves that scikit-learn reaches, for every float32 input."""

import dataclasses
from typing import Any

import cffi
import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor, RandomForestRegressor
from support.paths import C_TESTS

from springpot.codegen.errors import UsageError
from springpot.codegen.model.forest import (
    find_used_features,
    fit_quantisation,
    predict_forest_n,
    quantise_leaves,
    to_bins,
)
from springpot.codegen.model.regressors import Forest, Quantisation
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.stages.compact_forest import CompactForest, compact_forest
from springpot.runtime_c.paths import INCLUDE, SOURCE
from springpot.trainer.models.ensembles import convert_forest
from springpot.trainer.models.fit import PAPER_LEAF, PAPER_TREES

HARNESS = C_TESTS / "forest_harness.c"
N_FEATURES = 10
DECLARATIONS = """
void compact_sums(void **, uint32_t *, uint32_t, uint32_t, float *, uint32_t *);
uint32_t forest_simd(void);
"""


def random_features(rows: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(rows, N_FEATURES)).astype(np.float32)


def fitted(trees: int, leaf: int, rows: int, kind: type = RandomForestRegressor, features=None):
    rng = np.random.default_rng(5)
    features = random_features(rows, 5) if features is None else features
    force_n = features @ rng.normal(size=N_FEATURES) + rng.normal(size=rows)
    model = kind(n_estimators=trees, min_samples_leaf=leaf, max_features=1 / 3, random_state=0)
    return model.fit(features, force_n)


def harness() -> tuple[cffi.FFI, Any]:
    path = shared_library([HARNESS], [SOURCE, INCLUDE / "float"])
    loaded = CLibrary(path, DECLARATIONS)
    return loaded.ffi, loaded.c


def variants() -> range:
    """Ways of traversal that this processor has: plain C, AVX2, AVX-512."""
    return range(harness()[1].forest_simd() + 1)


def c_sums(forest: CompactForest, features: np.ndarray, simd: int) -> np.ndarray:
    ffi, library = harness()
    starts = np.cumsum([0, *map(len, forest.thresholds)]).astype(np.uint32)
    searched = np.concatenate(forest.thresholds) if forest.thresholds else None
    tables = [forest.top, forest.nodes, forest.roots, searched, starts]
    kept = [ffi.NULL if table is None else ffi.from_buffer(table) for table in tables]
    sizes = [forest.n_trees, forest.top.shape[1], features.shape[1]]
    sums = np.empty(len(features), dtype=np.uint32)
    library.compact_sums(
        ffi.new("void *[]", kept), ffi.new("uint32_t[]", sizes), simd, len(features),
        ffi.from_buffer("float[]", features), ffi.from_buffer("uint32_t[]", sums),
    )  # fmt: skip
    return sums


def labelled(forest: Forest) -> Forest:
    """Leaves with random labels of all 16 bits for forces: equal sums mean equal leaves."""
    labels = np.random.default_rng(9).integers(1, 2**16 - 1, len(forest.feature))
    leaves = np.flatnonzero(forest.feature < 0)
    labels[leaves[0]], labels[leaves[-1]] = 0, 2**16 - 1
    return dataclasses.replace(forest, value_n=labels.astype(np.float64), weight=1.0)


def near_thresholds(forest: Forest, rng: np.random.Generator) -> np.ndarray:
    """Random vectors in which one feature is a threshold, or one ulp on either side of it."""
    inner = np.flatnonzero(forest.feature >= 0)
    nearest = forest.threshold[inner].astype(np.float32)
    up, down = np.float32(np.inf), np.float32(-np.inf)
    around = [nearest, np.nextafter(nearest, up), np.nextafter(nearest, down)]
    features = rng.normal(size=(3 * len(inner), N_FEATURES)).astype(np.float32)
    features[np.arange(len(features)), np.tile(forest.feature[inner], 3)] = np.concatenate(around)
    return features


def assert_same_leaves(
    model, features: np.ndarray, quantisation: Quantisation | None = None
) -> None:
    """Every way of traversal; rounded: the forest was fitted on whole steps."""
    forest = dataclasses.replace(convert_forest(model), quantisation=quantisation)
    marked = labelled(forest)
    expected = marked.value_n[model.apply(features) + forest.roots].sum(axis=1).astype(np.uint32)
    used = np.ascontiguousarray(features[:, find_used_features(forest)])
    leaves = quantise_leaves(marked)
    compact = compact_forest(marked, leaves)
    for simd in variants():
        np.testing.assert_array_equal(c_sums(compact, used, simd), expected)
    np.testing.assert_array_equal(predict_forest_n(marked, leaves, features, np.float64), expected)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", [RandomForestRegressor, ExtraTreesRegressor])
@pytest.mark.parametrize("trees", [1, 13, 30])
def test_same_leaves_as_scikit_learn_near_every_threshold(kind: type, trees: int) -> None:
    model = fitted(trees=trees, leaf=3, rows=2000, kind=kind)
    assert_same_leaves(model, near_thresholds(convert_forest(model), np.random.default_rng(2)))


# Trees, and rows that are compared: a fifth of the paper's forest, and all of it.
SIZES = [(PAPER_TREES // 5, 200_000), (PAPER_TREES, 1_000_000)]


@pytest.mark.few(0, 1)
@pytest.mark.parametrize(("trees", "rows"), SIZES)
def test_same_leaves_as_scikit_learn_at_the_papers_size(trees: int, rows: int) -> None:
    model = fitted(trees=trees, leaf=PAPER_LEAF, rows=9770)
    near = near_thresholds(convert_forest(model), np.random.default_rng(3))
    away = random_features(rows - len(near), 3)
    assert_same_leaves(model, np.concatenate([near, away]))


@pytest.mark.few(1, 1)
@pytest.mark.parametrize(("trees", "rows"), SIZES)
def test_same_leaves_as_scikit_learn_on_rounded_features(trees: int, rows: int) -> None:
    features = random_features(9770, 5)
    quantisation = fit_quantisation(features.astype(np.float64))
    steps = to_bins(quantisation, features)
    model = fitted(trees=trees, leaf=PAPER_LEAF, rows=9770, features=steps)
    inner = convert_forest(model)
    near = np.floor(near_thresholds(inner, np.random.default_rng(8)))
    away = to_bins(quantisation, random_features(rows - len(near), 11))
    assert_same_leaves(model, np.clip(np.concatenate([near, away]), 0, 65535), quantisation)


def test_force_is_the_mean_of_the_leaves_within_the_stated_rounding() -> None:
    model = fitted(trees=11, leaf=5, rows=1500)
    forest = convert_forest(model)
    features, leaves = random_features(3000, 4), quantise_leaves(forest)
    force_n = predict_forest_n(forest, leaves, features, np.float64)
    span_n = np.ptp(forest.value_n[forest.feature < 0])
    assert np.abs(force_n - model.predict(features)).max() <= leaves.error_n
    assert leaves.error_n == pytest.approx(span_n / 2**17, rel=1e-4)


def test_too_many_features_are_refused() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(400, 16)).astype(np.float32)
    model = RandomForestRegressor(n_estimators=20, random_state=0).fit(features, features.sum(1))
    with pytest.raises(UsageError, match="16 features"):
        compact_forest(convert_forest(model), quantise_leaves(convert_forest(model)))


def test_ranks_are_those_of_a_whole_search_however_far_a_feature_jumps() -> None:
    model = fitted(trees=20, leaf=2, rows=3000)
    forest = labelled(convert_forest(model))
    leaves = quantise_leaves(forest)
    compact, rng = compact_forest(forest, leaves), np.random.default_rng(13)
    slow = np.cumsum(rng.normal(scale=1e-3, size=(3000, N_FEATURES)), axis=0)
    jumps = rng.normal(size=(3000, N_FEATURES)) * (rng.random((3000, 1)) < 0.1)
    features = np.ascontiguousarray((slow + jumps).astype(np.float32))
    expected = predict_forest_n(forest, leaves, features, np.float64)
    for simd in variants():
        np.testing.assert_array_equal(c_sums(compact, features, simd), expected)
