"""Forest as nested ifs by m2cgen: for small forests, and the independent oracle of the tests."""

import sys

from m2cgen import ast
from m2cgen.interpreters import CInterpreter

from springpot.codegen.errors import UsageError
from springpot.codegen.forest.node_table import LEAF_SLOT, WIDE_SLOT_BITS, ForestTable
from springpot.codegen.model.regressors import Forest

MAX_NODES = 20_000
_HEAD = "double score(double * input)"


def score_source(forest: Forest, table: ForestTable) -> str:
    """C function forest_score: the sum of the quantised leaves, the same number as the table's.

    Leaves are whole numbers, so that the sum is exact in any order. Raises UsageError for forests
    that a compiler would take minutes over.
    """
    if len(table.value) > MAX_NODES:
        raise UsageError(
            f'runtime.forest = "m2cgen": {len(table.value)} nodes would take minutes to compile '
            f'(limit {MAX_NODES}): use "table"'
        )
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 20_000))
    trees = [_tree(table, int(row)) for row in table.roots[: len(forest.roots)]]
    text = str(CInterpreter().interpret(_balanced_sum(trees)))
    return text[text.index(_HEAD) :].replace(
        _HEAD, "static inline double forest_score(const double *input)"
    )


def _tree(table: ForestTable, row: int) -> ast.Expr:
    link = int(table.link[row])
    value = ast.NumVal(float(table.value[row]))
    slot, left = link & LEAF_SLOT, link >> WIDE_SLOT_BITS
    if slot == LEAF_SLOT:
        return value
    # The threshold is a float32 number written as a double; so is the feature: same decision.
    test = ast.CompExpr(ast.FeatureRef(slot), value, ast.CompOpType.LTE)
    return ast.IfExpr(test, _tree(table, left), _tree(table, left + 1))


def _balanced_sum(terms: list[ast.Expr]) -> ast.Expr:
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return ast.BinNumExpr(
        _balanced_sum(terms[:half]), _balanced_sum(terms[half:]), ast.BinNumOpType.ADD
    )
