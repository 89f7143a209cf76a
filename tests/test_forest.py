"""The C forest reaches the leaves that scikit-learn reaches, for every float32 input."""

import dataclasses
from pathlib import Path

import cffi
import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor, RandomForestRegressor

from springpot.codegen.forest_table import (
    LANES,
    LEAF_SLOT,
    SLOT_BITS,
    forest_table,
    largest_float32_below,
    used_features,
)
from springpot.codegen.forest_walk import forest_force, forest_leaves
from springpot.codegen.ir import Forest
from springpot.host.compiler import shared_library
from springpot.runtime_c.errors import UsageError
from springpot.runtime_c.paths import SOURCE
from springpot.trainer.fit import PAPER_LEAF, PAPER_TREES
from springpot.trainer.forests import unscaled
from springpot.trainer.tree_ir import forest_ir

HARNESS = Path(__file__).parent / "c" / "forest_harness.c"
N_FEATURES = 10


def fitted(trees: int, leaf: int, rows: int, kind: type = RandomForestRegressor):
    rng = np.random.default_rng(5)
    features = rng.normal(size=(rows, N_FEATURES)).astype(np.float32)
    force_n = features @ rng.normal(size=N_FEATURES) + rng.normal(size=rows)
    model = kind(n_estimators=trees, min_samples_leaf=leaf, max_features=1 / 3, random_state=0)
    return model.fit(features, force_n)


def c_sums(table, features: np.ndarray) -> np.ndarray:
    library = shared_library([HARNESS], [SOURCE])
    ffi = cffi.FFI()
    ffi.cdef(
        "void forest_sums(void *, uint32_t *, uint32_t, uint32_t, uint32_t, uint32_t, float *,"
        " int32_t *);"
    )
    nodes = np.zeros(len(table.value), dtype=[("value", "<f4"), ("link", "<u4")])
    nodes["value"], nodes["link"] = table.value, table.link
    sums = np.empty(len(features), dtype=np.int32)
    ffi.dlopen(str(library)).forest_sums(
        ffi.from_buffer(nodes), ffi.from_buffer("uint32_t[]", table.roots), len(table.roots),
        table.depth, len(features), features.shape[1],
        ffi.from_buffer("float[]", features), ffi.from_buffer("int32_t[]", sums),
    )  # fmt: skip
    return sums


def labelled(forest: Forest) -> Forest:
    """Leaves with random 24-bit labels for forces: equal sums mean equal leaves."""
    labels = np.random.default_rng(9).integers(1, 2**24 - 1, len(forest.feature))
    labels[0] = 2**24 - 1
    return dataclasses.replace(forest, value_n=labels.astype(np.float64))


def near_thresholds(forest: Forest, rng: np.random.Generator) -> np.ndarray:
    """Random vectors in which one feature is a threshold, or one ulp on either side of it."""
    inner = np.flatnonzero(forest.feature >= 0)
    nearest = forest.threshold[inner].astype(np.float32)
    up, down = np.float32(np.inf), np.float32(-np.inf)
    around = [nearest, np.nextafter(nearest, up), np.nextafter(nearest, down)]
    features = rng.normal(size=(3 * len(inner), N_FEATURES)).astype(np.float32)
    features[np.arange(len(features)), np.tile(forest.feature[inner], 3)] = np.concatenate(around)
    return features


def assert_same_leaves(model, features: np.ndarray) -> None:
    forest = forest_ir(model)
    marked = labelled(forest)
    table = forest_table(marked, np.float64)
    columns = used_features(forest)
    leaves = model.apply(features) + forest.roots
    unit = 2.0 * table.leaf_error_n
    expected = np.rint(marked.value_n[leaves] / unit).sum(axis=1).astype(np.int64)
    sums = c_sums(table, np.ascontiguousarray(features[:, columns]))
    np.testing.assert_array_equal(sums, expected)


@pytest.mark.parametrize("kind", [RandomForestRegressor, ExtraTreesRegressor])
def test_same_leaves_as_scikit_learn_near_every_threshold(kind: type) -> None:
    model = fitted(trees=13, leaf=3, rows=2000, kind=kind)
    assert_same_leaves(model, near_thresholds(forest_ir(model), np.random.default_rng(2)))


def test_same_leaves_as_scikit_learn_at_the_papers_size() -> None:
    model = fitted(trees=PAPER_TREES, leaf=PAPER_LEAF, rows=9770)
    rng = np.random.default_rng(3)
    near = near_thresholds(forest_ir(model), rng)
    away = rng.normal(size=(1_000_000 - len(near), N_FEATURES)).astype(np.float32)
    assert_same_leaves(model, np.concatenate([near, away]))


def test_force_is_the_mean_of_the_leaves_within_the_stated_rounding() -> None:
    model = fitted(trees=11, leaf=5, rows=1500)
    forest = forest_ir(model)
    table = forest_table(forest, np.float64)
    features = np.random.default_rng(4).normal(size=(3000, N_FEATURES)).astype(np.float32)
    force_n = forest_force(table, features[:, used_features(forest)])
    assert np.abs(force_n - model.predict(features)).max() <= table.leaf_error_n
    assert table.leaf_error_n < 1e-6


def test_the_reference_walks_like_the_c() -> None:
    model = fitted(trees=9, leaf=2, rows=800)
    table = forest_table(forest_ir(model), np.float32)
    features = np.random.default_rng(6).normal(size=(500, N_FEATURES)).astype(np.float32)
    leaves = forest_leaves(table, features)
    assert leaves.shape == (500, 16)
    np.testing.assert_array_equal(
        c_sums(table, features), table.value[leaves].astype(np.int64).sum(axis=1)
    )


def test_only_a_power_of_two_folds_back_exactly() -> None:
    model = fitted(trees=5, leaf=3, rows=2000)
    forest = forest_ir(model)
    features = near_thresholds(forest, np.random.default_rng(7))
    scale = 64.0
    folded = labelled(unscaled(forest, scale))
    table = forest_table(folded, np.float64)
    leaves = model.apply(features) + forest.roots
    expected = np.rint(folded.value_n[leaves] / (2 * table.leaf_error_n)).sum(axis=1)
    np.testing.assert_array_equal(c_sums(table, features / np.float32(scale)), expected)


def test_float32_thresholds_round_down() -> None:
    doubles = np.array([0.1, -0.1, 1.0, 1.0 + 1e-12, 1.0 - 1e-12, 3.5e-46, 0.0])
    rounded = largest_float32_below(doubles).astype(np.float64)
    above = np.nextafter(rounded.astype(np.float32), np.float32(np.inf)).astype(np.float64)
    assert np.all(rounded <= doubles)
    assert np.all(above > doubles)


def test_facts_of_the_header() -> None:
    text = (SOURCE / "sp_forest.h").read_text()
    assert f"SP_FOREST_SLOT_BITS = {SLOT_BITS}" in text
    assert f"SP_FOREST_LANES = {LANES}" in text
    assert LEAF_SLOT == 2**SLOT_BITS - 1


def test_a_forest_of_one_leaf_still_renders() -> None:
    forest = Forest(
        feature=np.array([-1], dtype=np.int32),
        threshold=np.zeros(1),
        left=np.zeros(1, dtype=np.int32),
        right=np.zeros(1, dtype=np.int32),
        value_n=np.array([2.5]),
        roots=np.array([0], dtype=np.int32),
        weight=1.0,
        bias_n=0.0,
    )
    table = forest_table(forest, np.float32)
    assert forest_force(table, np.zeros((1, 1), dtype=np.float32))[0] == 2.5


def test_too_many_features_are_refused() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(400, 16)).astype(np.float32)
    model = RandomForestRegressor(n_estimators=20, random_state=0).fit(features, features.sum(1))
    with pytest.raises(UsageError, match="16 features"):
        forest_table(forest_ir(model), np.float32)
