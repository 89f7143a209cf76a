"""Forests: sp_forest.h, or nested ifs by m2cgen."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from springpot.codegen.arrays import Reals
from springpot.codegen.errors import UsageError
from springpot.codegen.forest.compact import LEVELS, CompactForest, compact_forest, work_at_most
from springpot.codegen.forest.leaves import rounded
from springpot.codegen.forest.node_table import ForestTable, forest_table
from springpot.codegen.forest.traverse import compact_sums, feature_bins, forest_force, table_sums
from springpot.codegen.literals import array_text, constant_text, members_text, wrapped
from springpot.codegen.model.regressors import Forest, Quantisation
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.costs import Costs
from springpot.codegen.stages.stage import (
    U32,
    Columns,
    Member,
    RegressorStage,
    regressor_stage,
    stage_code,
)
from springpot.codegen.types import JsonObject, RealType

_LEVELS_A_ROUND = 3  # SP_FOREST_UNCHECKED


@dataclass(frozen=True, eq=False)
class CompactForestStage(RegressorStage):
    """A forest on `n_features` features in 4-byte nodes; `vectors`: with the host's vector units.

    quantisation: of the features used, where the forest was fitted on bins.
    """

    forest: CompactForest
    n_features: int
    quantisation: Quantisation | None
    vectors: bool

    code = stage_code("compact_forest")

    @property
    def headers(self) -> tuple[str, ...]:
        bins = "sp_quantise.h" if self.quantisation is not None else "sp_bins.h"
        traversal = ("sp_forest.h", "sp_forest_x86.h", "sp_forest_simd.h")
        return (bins, *(traversal if self.vectors else traversal[:1]))

    @property
    def members(self) -> tuple[Member, ...]:
        """Which vector unit there is; where each feature's bin was."""
        simd = (Member("uint32_t simd", (U32,)),) if self.vectors else ()
        searched = len(self.forest.thresholds)
        bins = (Member(f"uint32_t bins[{searched}]", (U32,) * searched),) if searched else ()
        return simd + bins

    def tables(self) -> list[str]:
        forest = self.forest
        return [
            f"enum {{\n    N_FEATURES = {self.n_features}\n}};",
            *_scale(forest),
            *(
                _rounding(self.quantisation)
                if self.quantisation is not None
                else self._thresholds()
            ),
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
        lists = self.forest.thresholds
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
        return self.forest.top.nbytes + self.forest.nodes.nbytes

    def instructions(self, costs: Costs) -> float:
        below = np.maximum(self.forest.longest_paths - LEVELS, 0)
        rounds = below // _LEVELS_A_ROUND + 1
        steps = sum(len(thresholds).bit_length() for thresholds in self.forest.thresholds)
        each = costs.quantisation if self.quantisation is not None else costs.bin_search
        return float(
            len(below) * costs.tree
            + rounds.sum() * costs.tree_round
            + steps * costs.bin_step
            + self.n_features * each
            + 80.0
        )

    def manifest(self) -> JsonObject:
        return {
            "leaf_error_n": self.forest.leaf_error_n,
            "work_at_most": work_at_most(self.forest),
        }

    def reference(self, features: Reals) -> Reals:
        if self.quantisation is None:
            bins = feature_bins(self.forest.thresholds, features.astype(np.float32))
        else:
            bins = rounded(self.quantisation, features).astype(np.int32)
        return forest_force(self.forest, compact_sums(self.forest, bins))


@dataclass(frozen=True, eq=False)
class IfsStage(RegressorStage):
    """The same forest as nested ifs, by m2cgen, on features as doubles."""

    table: ForestTable
    n_features: int
    quantisation: Quantisation | None
    forest: Forest

    code = stage_code("ifs_forest")

    @property
    def headers(self) -> tuple[str, ...]:
        return ("sp_quantise.h",) if self.quantisation is not None else ()

    def tables(self) -> list[str]:
        from springpot.codegen.forest.m2c import score_source

        steps = [] if self.quantisation is None else _rounding(self.quantisation)
        head = f"enum {{\n    N_FEATURES = {self.n_features}\n}};"
        return [head, *_scale(self.table), *steps, score_source(self.forest, self.table)]

    def manifest(self) -> JsonObject:
        return {"leaf_error_n": self.table.leaf_error_n}

    def reference(self, features: Reals) -> Reals:
        values = features.astype(np.float32)
        if self.quantisation is not None:
            values = rounded(self.quantisation, values)
        return forest_force(self.table, table_sums(self.table, values))


@regressor_stage.register
def forest_stage(
    forest: Forest, kept: Columns, runtime: Runtime, dtype: RealType
) -> RegressorStage:
    """Nodes of 4 bytes; nested ifs where the scene asks for them.

    Raises UsageError for a forest that is too large for nodes of 4 bytes.
    """
    quantisation = None if forest.quantisation is None else forest.quantisation.take(kept)
    if runtime.forest == "m2cgen":
        return IfsStage(forest_table(forest, dtype), len(kept), quantisation, forest)
    compact = compact_forest(forest, dtype)
    if compact is None:
        raise UsageError(
            "the forest is too large for the C's nodes of 4 bytes: fit fewer trees or larger "
            "leaves (train --trees, --leaf), or features in steps (train --round-features)"
        )
    return CompactForestStage(compact, len(kept), quantisation, vectors=runtime.target == "host")


def _nodes(name: str, nodes: Any) -> list[str]:
    pairs = [f"{{{step}, {bin_index}}}" for step, bin_index in nodes.tolist()]
    return [f"static const sp_forest_node {name}[{len(pairs)}] = {{", *wrapped(pairs), "};"]


def _rounding(quantisation: Quantisation) -> list[str]:
    return [
        "/* A feature's minimum, and its bins in a unit (sp_quantise.h). */",
        array_text("feature_min", "float", quantisation.feature_min.astype(np.float32)),
        array_text("bins_per_unit", "float", quantisation.bins_per_unit.astype(np.float32)),
    ]


def _scale(table: ForestTable | CompactForest) -> list[str]:
    return [
        constant_text("leaf_step_n", table.leaf_step_n),
        constant_text("forest_bias_n", table.bias_n),
    ]
