"""All single changes of a Python text: comparisons, logic, signs, arithmetic, constants,
assignments, calls and refusals that are not there. Wording is left alone: texts with a blank, and
what an error says.
"""

import ast
import re
from collections.abc import Iterator
from types import CodeType

from mutant import OTHER_OPERATORS, Mutant

_OTHERS = {
    **OTHER_OPERATORS,
    "is not": ("is",),
    "is": ("is not",),
    "not in": ("in",),
    "in": ("not in",),
    "and": ("or",),
    "or": ("and",),
    "//": ("*",),
    "**": ("*",),
}
_OPERATOR = re.compile(
    r"is\s+not\b|not\s+in\b|\b(?:is|in|and|or)\b|<<|>>|\*\*|//|[<>=!]=|[-+*/%&|^<>]"
)
_COMMENT = re.compile(r"#[^\n]*")
_Placed = ast.expr | ast.stmt  # what has a place in the text


def same_program(one: str, other: str) -> bool:
    """Whether two texts are the same bytecode; also where the other is no Python."""
    try:
        return _content(compile(one, "", "exec")) == _content(compile(other, "", "exec"))
    except (SyntaxError, ValueError):
        return True


def _content(code: CodeType) -> tuple[object, ...]:
    constants = tuple(
        _content(value) if isinstance(value, CodeType) else (type(value), repr(value))
        for value in code.co_consts
    )
    return code.co_code, constants, code.co_names, code.co_varnames


def mutants_of_python(text: str) -> Iterator[Mutant]:
    """Every single change of a Python text, in order, each once."""
    found = _Mutants(text)
    found.visit(ast.parse(text))
    yield from sorted(dict.fromkeys(found.all), key=lambda mutant: mutant.start)


class _Mutants(ast.NodeVisitor):
    def __init__(self, text: str) -> None:
        self.all: list[Mutant] = []
        self._text = text
        self._lines = text.splitlines(keepends=True)
        starts = [0]
        for line in self._lines:
            starts.append(starts[-1] + len(line))
        self._starts = starts

    def _at(self, line: int, column: int) -> int:
        before = self._lines[line - 1].encode()[:column].decode()
        return self._starts[line - 1] + len(before)

    def _begin(self, node: _Placed) -> int:
        return self._at(node.lineno, node.col_offset)

    def _end(self, node: _Placed) -> int:
        return self._at(node.end_lineno, node.end_col_offset)

    def _put(self, node: _Placed, *texts: str) -> None:
        self.all += [Mutant(self._begin(node), self._end(node), text) for text in texts]

    def _between(self, left: _Placed, right: _Placed) -> None:
        """The operator between two operands, and nothing of a comment."""
        start = self._end(left)
        gap = _COMMENT.sub(
            lambda found: " " * len(found[0]), self._text[start : self._begin(right)]
        )
        found = _OPERATOR.search(gap)
        if found:
            for new in _OTHERS[" ".join(found[0].split())]:
                self.all.append(Mutant(start + found.start(), start + found.end(), new))

    def _negate(self, test: ast.expr) -> None:
        if not isinstance(test, ast.Compare | ast.BoolOp | ast.UnaryOp):
            self._put(test, f"(not ({ast.get_source_segment(self._text, test)}))")

    def visit_Compare(self, node: ast.Compare) -> None:
        for left, right in zip([node.left, *node.comparators], node.comparators, strict=False):
            self._between(left, right)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        for left, right in zip(node.values, node.values[1:], strict=False):
            self._between(left, right)
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self._between(node.left, node.right)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._between(node.target, node.value)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        length = 3 if isinstance(node.op, ast.Not) else 1
        self.all.append(Mutant(self._begin(node), self._begin(node) + length, ""))
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self._put(node, str(not value))
        elif isinstance(value, int):
            self._put(node, str(value + 1), *([str(value - 1)] if value > 0 else []))
        elif isinstance(value, float):
            self._put(node, *([f"(2 * {value!r})", f"(0.5 * {value!r})"] if value else ["1.0"]))
        elif isinstance(value, str | bytes) and not re.search(r"\s", str(value)):
            mark = 'b"XX" ' if isinstance(value, bytes) else '"XX" '
            self._put(node, mark + self._text[self._begin(node) : self._end(node)])

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Wording."""

    def visit_arg(self, node: ast.arg) -> None:
        """Annotations of arguments say nothing at run time."""

    def visit_If(self, node: ast.If) -> None:
        self._negate(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        self._negate(node.test)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        for test in node.ifs:
            self._negate(test)
        self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> None:
        self._nothing(node.value)
        self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._nothing(node.value)
        self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None:
            self._nothing(node.value)
        self.generic_visit(node)

    def _nothing(self, value: ast.expr) -> None:
        if not isinstance(value, ast.Constant):
            self._put(value, "None")

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self._put(node, "...")
            self.generic_visit(node)
        elif not isinstance(node.value, ast.Constant):
            self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        self._put(node, "...")  # its words are its own

    def visit_Break(self, node: ast.Break) -> None:
        self._put(node, "continue")

    def visit_Continue(self, node: ast.Continue) -> None:
        self._put(node, "break")

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for default in [*node.args.defaults, *node.args.kw_defaults]:
            if default is not None:
                self.visit(default)
        for statement in [*node.decorator_list, *node.body]:
            self.visit(statement)
