"""The stage of expressions: C that m2cgen writes, and the same C run here in numpy's place."""

import re
import sys
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from springpot.codegen.arrays import Reals, Samples
from springpot.codegen.errors import UsageError
from springpot.codegen.literals import array_text
from springpot.codegen.model.regressors import OPERATIONS, Expression, Regressor
from springpot.codegen.native.c_library import CLibrary
from springpot.codegen.native.compiler import shared_library
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.stage import Columns, RegressorStage, regressor_stage, stage_code
from springpot.codegen.types import RealType

if TYPE_CHECKING:
    from m2cgen.ast import Expr

_BODY = re.compile(r"\{\n(.*)\}", re.DOTALL)
_RUN = "void run(const double *inputs, long rows, long width, double *force_n)"
_LOOP = "{ for (long i = 0; i < rows; i++) force_n[i] = sp_sum_terms(inputs + i * width); }"


@dataclass(frozen=True, eq=False)
class ExpressionStage(RegressorStage):
    """A sum of terms in double, each a C function by m2cgen."""

    expression: Expression
    dtype: RealType

    headers: ClassVar[tuple[str, ...]] = ()
    code = stage_code("expression")

    def tables(self) -> list[str]:
        """Render the scaling of the inputs, and the C function that m2cgen writes."""
        expression = self.expression
        return [
            f"enum {{\n    N_INPUTS = {len(expression.column)}\n}};",
            array_text("input_column", "uint32_t", expression.column.astype(np.uint32)),
            array_text("input_zero", "double", expression.zero),
            array_text("input_gain", "double", expression.gain),
            "",
            _terms_text(expression.operation.tobytes(), expression.operand.tobytes()),
        ]

    def reference(self, features: Reals) -> Reals:
        return run_expression(self.expression, features).astype(self.dtype)


@regressor_stage.register
def expression_stage(
    expression: Expression, used: Columns, runtime: Runtime, dtype: RealType
) -> ExpressionStage:
    """Raises UsageError for a bare board."""
    if runtime.target != "host":
        require_no_libm(expression, f'runtime.target = "{runtime.target}"')
    return ExpressionStage(expression, dtype)


def require_no_libm(regressor: Regressor | None, where: str) -> None:
    """Raise UsageError for a regressor that computes with functions that are not there."""
    if regressor is not None and regressor.needs_libm:
        raise UsageError(
            f"{where}: this regressor computes in double, with exp or pow of libm, which are not "
            "there, or take too long without a unit for them: fit trees, or what is linear in the "
            "features"
        )


def run_expression(expression: Expression, features: Reals) -> Samples:
    """Force of features (n, features), (n,), N, by the C that is emitted."""
    inputs = expression.zero + expression.gain * features[:, expression.column].astype(np.float64)
    inputs, force_n = np.ascontiguousarray(inputs), np.empty(len(features))
    library = _load(_terms_text(expression.operation.tobytes(), expression.operand.tobytes()))
    arrays = library.array(inputs), len(inputs), inputs.shape[1], library.array(force_n)
    library.c.run(*arrays)
    return force_n


@lru_cache(8)
def _load(text: str) -> CLibrary:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "expression.c"
        source = f"#include <math.h>\n#include <stddef.h>\n{text}\n{_RUN}\n{_LOOP}\n"
        file.write_text(source, encoding="utf-8", newline="\n")
        return CLibrary(shared_library([file], []), f"{_RUN};")


@lru_cache(8)
def _terms_text(operation: bytes, operand: bytes) -> str:
    """C of the terms, and of `sp_sum_terms`: called by address, as a compiler that joins them all
    takes minutes over a thousand."""  # fmt: skip
    from m2cgen.interpreters import CInterpreter

    sys.setrecursionlimit(max(sys.getrecursionlimit(), 20_000))  # of hundreds of trees in an exp
    functions = []
    for number, term in enumerate(_build_terms(np.frombuffer(operation, np.int32), operand)):
        body = _BODY.search(CInterpreter().interpret(term))
        assert body is not None
        functions.append(f"static double sp_term_{number}(const double *input)\n{{\n{body[1]}}}\n")
    names = ",\n    ".join(f"sp_term_{number}" for number in range(len(functions)))
    count = "sizeof(sp_terms) / sizeof(sp_terms[0])"
    return "\n".join([
        *functions,
        f"static double (*const sp_terms[])(const double *) = {{\n    {names},\n}};\n",
        "static double sp_sum_terms(const double *input)\n{\n    double sum = 0.0;",
        f"    for (size_t i = 0; i < {count}; i++) {{\n        sum += sp_terms[i](input);\n    }}",
        "    return sum;\n}",
    ])  # fmt: skip


def _build_terms(operation: Samples, operand: bytes) -> "list[Expr]":
    """Build m2cgen's expressions from a postfix program: each operation takes the last results."""
    from m2cgen import ast

    names, stack = list(OPERATIONS), list["Expr"]()
    for name, value in zip((names[i] for i in operation), np.frombuffer(operand), strict=True):
        taken = stack[len(stack) - OPERATIONS[name] :]
        del stack[len(stack) - len(taken) :]
        if name in ast.BinNumOpType.__members__:
            stack.append(ast.BinNumExpr(*taken, ast.BinNumOpType[name]))
        elif name in ast.CompOpType.__members__:
            stack.append(ast.CompExpr(*taken, ast.CompOpType[name]))
        elif name == "FeatureRef":
            stack.append(ast.FeatureRef(int(value)))
        else:
            stack.append(getattr(ast, name)(*(taken or [float(value)])))
    return stack
