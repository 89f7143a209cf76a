"""Forests: sp_forest.h, or nested ifs by m2cgen."""

from dataclasses import dataclass

import numpy as np

from springpot.codegen.configs import ForestTable
from springpot.codegen.forest_walk import forest_force
from springpot.codegen.ir import Forest
from springpot.codegen.literals import array_text, literal, wrapped
from springpot.codegen.stages.stage import Reals


@dataclass(frozen=True, eq=False)
class ForestStage:
    """A forest on `n_features` features as a node table."""

    table: ForestTable
    n_features: int

    headers = ("sp_forest.h",)

    def tables(self) -> list[str]:
        """Nodes, roots, sizes and scale."""
        table = self.table
        pairs = [
            f"{{{literal(value)}, {link}u}}"
            for value, link in zip(table.value, table.link.tolist(), strict=True)
        ]
        return [
            f"enum {{\n    N_FEATURES = {self.n_features},\n    N_ROOTS = {len(table.roots)},\n"
            f"    DEPTH = {table.depth}\n}};",
            *_scale(table),
            "/* Trees, one after the other: threshold or leaf, link (sp_forest.h). */",
            f"static const sp_forest_node nodes[{len(pairs)}] = {{",
            *wrapped(pairs),
            "};",
            array_text("roots", "uint32_t", table.roots),
        ]

    def force(self) -> list[str]:
        """Sum of leaves, in quanta."""
        return [
            "float slots[SP_FOREST_SLOTS];",
            "for (uint32_t i = 0; i < N_FEATURES; i++) {",
            "    slots[i] = (float)features[i];",
            "}",
            "const int32_t quanta = sp_forest_sum(nodes, roots, N_ROOTS, DEPTH, slots);",
            "const sp_real model_n = forest_bias_n + (sp_real)quanta * quantum_n;",
        ]

    def reference(self, features: Reals) -> Reals:
        """The same leaves and sums."""
        return forest_force(self.table, features.astype(np.float32))


@dataclass(frozen=True, eq=False)
class IfsStage:
    """The same forest as nested ifs."""

    forest: Forest
    table: ForestTable
    n_features: int

    headers = ()

    def tables(self) -> list[str]:
        """The function forest_score."""
        from springpot.codegen.m2c import score_source

        size = f"enum {{\n    N_FEATURES = {self.n_features}\n}};"
        return [size, *_scale(self.table), score_source(self.forest, self.table)]

    def force(self) -> list[str]:
        """Sum of leaves, in quanta."""
        return [
            "double slots[N_FEATURES];",
            "for (uint32_t i = 0; i < N_FEATURES; i++) {",
            "    slots[i] = (double)(float)features[i];",
            "}",
            "const int32_t quanta = (int32_t)forest_score(slots);",
            "const sp_real model_n = forest_bias_n + (sp_real)quanta * quantum_n;",
        ]

    def reference(self, features: Reals) -> Reals:
        """The same leaves and sums."""
        return forest_force(self.table, features.astype(np.float32))


def _scale(table: ForestTable) -> list[str]:
    return [
        f"static const sp_real quantum_n = {literal(table.quantum_n)};",
        f"static const sp_real forest_bias_n = {literal(table.bias_n)};",
    ]
