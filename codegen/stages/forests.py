"""The stage of forests: compact nodes (sp_forest.h)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.literals import array_text, constant_text, members_text, wrap_items
from springpot.codegen.model.forest import (
    QuantisedLeaves,
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


@dataclass(frozen=True, eq=False)
class ForestStage(RegressorStage):
    """A forest on the `n_features` features that it uses, in 4-byte nodes.

    dtype: of sp_real; vectors: with the host's vector units.
    """

    forest: Forest
    leaves: QuantisedLeaves
    n_features: int
    dtype: RealType
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
        leaves, steps, forest = self.leaves, self.forest.quantisation, self.compact
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
        members = {
            "top": "forest_top",
            "nodes": "forest_nodes",
            "roots": "forest_roots",
            "n_trees": f"{forest.n_trees}",
            "n_padded": f"{forest.top.shape[1]}",
        }
        return [
            *lines,
            *self._thresholds(),
            "/* The first levels of all trees side by side: step, bin (sp_forest.h). */",
            *_nodes("forest_top", forest.top.reshape(-1, 2)),
            "/* Below, tree after tree. */",
            *_nodes("forest_nodes", forest.nodes),
            array_text("forest_roots", "uint32_t", forest.roots),
            members_text("forest", "sp_forest", members),
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

    def manifest(self) -> JsonObject:
        return {"leaf_error_n": self.leaves.error_n}

    def reference(self, features: Reals) -> Reals:
        values = features.astype(np.float32)
        if self.forest.quantisation is not None:
            values = to_bins(self.forest.quantisation, values)
        return predict_forest_n(self.forest, self.leaves, values, self.dtype)

    @property
    def table_bytes(self) -> int:
        return self.compact.top.nbytes + self.compact.nodes.nbytes


@regressor_stage.register
def forest_stage(
    forest: Forest, used: Columns, runtime: Runtime, dtype: RealType
) -> RegressorStage:
    """Raise UsageError for a forest that is too large."""
    forest = forest.on_columns(used)
    leaves = quantise_leaves(forest)
    compact = compact_forest(forest, leaves)
    vectors = runtime.target == "host"
    return ForestStage(forest, leaves, len(used), dtype, compact, vectors)


def _nodes(name: str, nodes: Any) -> list[str]:
    pairs = [f"{{{step}, {bin_index}}}" for step, bin_index in nodes.tolist()]
    return [f"static const sp_forest_node {name}[{len(pairs)}] = {{", *wrap_items(pairs), "};"]
