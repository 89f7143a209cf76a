"""Stages of forests: compact nodes (sp_forest.h), or nested ifs by m2cgen."""

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.errors import UsageError
from springpot.codegen.literals import array_text, constant_text, members_text, wrap_items
from springpot.codegen.model.forest import (
    QuantisedLeaves,
    largest_float32_below,
    predict_forest_n,
    quantise_leaves,
    to_bins,
)
from springpot.codegen.model.regressors import Forest
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.compact_forest import CompactForest, compact_forest
from springpot.codegen.stages.stage import (
    U32,
    Columns,
    Member,
    RegressorStage,
    regressor_stage,
    stage_code,
)
from springpot.codegen.types import JsonObject, RealType

if TYPE_CHECKING:
    from m2cgen.ast import Expr

_MAX_IFS = 20_000  # nodes
_SCORE = "double score(double * input)"


@dataclass(frozen=True, eq=False)
class ForestStage(RegressorStage):
    """A forest on the `n_features` features that it uses. dtype: of sp_real."""

    forest: Forest
    leaves: QuantisedLeaves
    n_features: int
    dtype: RealType

    def tables(self) -> list[str]:
        """Render the C tables: scale of the leaves, and the function of nested ifs."""
        leaves, steps = self.leaves, self.forest.quantisation
        lines = [
            f"enum {{\n    N_FEATURES = {self.n_features}\n}};",
            constant_text("leaf_step_n", self.dtype(leaves.leaf_step_n)),
            constant_text("forest_bias_n", self.dtype(leaves.bias_n)),
        ]
        if steps is not None:
            lines += [
                "/* A feature's minimum, and its bins in a unit (sp_quantise.h). */",
                array_text("feature_min", "float", steps.feature_min.astype(np.float32)),
                array_text("bins_per_unit", "float", steps.bins_per_unit.astype(np.float32)),
            ]
        return lines

    def manifest(self) -> JsonObject:
        return {"leaf_error_n": self.leaves.error_n}

    def reference(self, features: Reals) -> Reals:
        values = features.astype(np.float32)
        if self.forest.quantisation is not None:
            values = to_bins(self.forest.quantisation, values)
        return predict_forest_n(self.forest, self.leaves, values, self.dtype)


@dataclass(frozen=True, eq=False)
class CompactForestStage(ForestStage):
    """In 4-byte nodes; `vectors`: with the host's vector units."""

    compact: CompactForest
    vectors: bool

    code = stage_code("compact_forest")

    @property
    def headers(self) -> tuple[str, ...]:
        bins = "sp_quantise.h" if self.forest.quantisation is not None else "sp_bins.h"
        traversal = ("sp_forest.h", "sp_forest_x86.h", "sp_forest_simd.h")
        return (bins, *(traversal if self.vectors else traversal[:1]))

    @property
    def members(self) -> tuple[Member, ...]:
        """Vector unit of the processor, and the last bin of each feature."""
        simd = (Member("uint32_t simd", (U32,)),) if self.vectors else ()
        searched = len(self.compact.thresholds)
        bins = (Member(f"uint32_t bins[{searched}]", (U32,) * searched),) if searched else ()
        return simd + bins

    def tables(self) -> list[str]:
        """Render the C tables: nodes, roots of the trees, thresholds, scale of the leaves."""
        forest = self.compact
        return [
            *super().tables(),
            *self._thresholds(),
            "/* The first levels of all trees side by side: step, bin (sp_forest.h). */",
            *_nodes("forest_top", forest.top.reshape(-1, 2)),
            "/* Below, tree after tree. */",
            *_nodes("forest_nodes", forest.nodes),
            array_text("forest_roots", "uint32_t", forest.roots),
            members_text(
                "forest",
                "sp_forest",
                {
                    "top": "forest_top",
                    "nodes": "forest_nodes",
                    "roots": "forest_roots",
                    "n_trees": f"{forest.n_trees}",
                    "n_padded": f"{forest.top.shape[1]}",
                },
            ),
        ]

    def _thresholds(self) -> list[str]:
        """Render the sorted thresholds, feature after feature, and where each feature's begin."""
        lists = self.compact.thresholds
        if not lists:
            return []
        starts = np.cumsum([0, *map(len, lists)]).astype(np.uint32)
        return [
            "/* Sorted thresholds of each feature. */",
            array_text("thresholds", "float", np.concatenate(lists)),
            array_text("threshold_starts", "uint32_t", starts),
        ]

    @property
    def table_bytes(self) -> int:
        return self.compact.top.nbytes + self.compact.nodes.nbytes


@dataclass(frozen=True, eq=False)
class IfsStage(ForestStage):
    """Forest as nested ifs by m2cgen, on features as doubles."""

    code = stage_code("ifs_forest")

    @property
    def headers(self) -> tuple[str, ...]:
        return ("sp_quantise.h",) if self.forest.quantisation is not None else ()

    def tables(self) -> list[str]:
        return [*super().tables(), render_score(self.forest, self.leaves)]


@regressor_stage.register
def forest_stage(
    forest: Forest, used: Columns, runtime: Runtime, dtype: RealType
) -> RegressorStage:
    """Nodes of 4 bytes; nested ifs where the scene asks for them.

    Raises UsageError for a forest that is too large for either.
    """
    forest = forest.on_columns(used)
    leaves = quantise_leaves(forest)
    if runtime.forest == "m2cgen":
        return IfsStage(forest, leaves, len(used), dtype)
    compact = compact_forest(forest, leaves)
    vectors = runtime.target == "host"
    return CompactForestStage(forest, leaves, len(used), dtype, compact, vectors)


def render_score(forest: Forest, leaves: QuantisedLeaves) -> str:
    """C function forest_score: the sum of the quantised leaves, the same number as the table's.

    Leaves are whole numbers, so that the sum is exact in any order. Raises UsageError for forests
    that a compiler would take minutes over.
    """
    from m2cgen import ast
    from m2cgen.interpreters import CInterpreter

    if len(forest.feature) > _MAX_IFS:
        raise UsageError(
            f'runtime.forest = "m2cgen": {len(forest.feature)} nodes would take minutes to compile '
            f'(limit {_MAX_IFS}): use "table"'
        )
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 20_000))
    threshold = largest_float32_below(forest.threshold).tolist()

    def tree(node: int) -> "Expr":
        if forest.feature[node] < 0:
            return ast.NumVal(float(leaves.quantised[node]))
        # The threshold is a float32 number written as a double; so is the feature: same decision.
        feature = ast.FeatureRef(int(forest.feature[node]))
        test = ast.CompExpr(feature, ast.NumVal(threshold[node]), ast.CompOpType.LTE)
        return ast.IfExpr(test, tree(int(forest.left[node])), tree(int(forest.right[node])))

    def balanced_sum(trees: "list[Expr]") -> "Expr":
        if len(trees) == 1:
            return trees[0]
        half = len(trees) // 2
        parts = (balanced_sum(trees[:half]), balanced_sum(trees[half:]))
        return ast.BinNumExpr(*parts, ast.BinNumOpType.ADD)

    text = str(CInterpreter().interpret(balanced_sum([tree(int(root)) for root in forest.roots])))
    head = "static inline double forest_score(const double *input)"
    return text[text.index(_SCORE) :].replace(_SCORE, head)


def _nodes(name: str, nodes: Any) -> list[str]:
    pairs = [f"{{{step}, {bin_index}}}" for step, bin_index in nodes.tolist()]
    return [f"static const sp_forest_node {name}[{len(pairs)}] = {{", *wrap_items(pairs), "};"]
