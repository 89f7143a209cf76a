"""Names of the functions of a source file, by line: what records of findings go by."""

import ast
import re

OUTSIDE = "outside"  # of every function
_C_BEGIN = re.compile(r"^\w[^;={]*?(\w+)\((?:[^;{}]*)\)\s*\{", re.MULTILINE | re.DOTALL)
_C_MACRO = re.compile(r"^#define[ \t]+(\w+)\((?:.*\\\n)*.*", re.MULTILINE)


def functions_by_line(text: str, *, is_python: bool) -> list[str]:
    """Name the innermost function of each line, the first line first."""
    names = [OUTSIDE] * (text.count("\n") + 1)
    for name, first, last in _python(text) if is_python else _c(text):
        names[first - 1 : last] = [name] * (last - first + 1)
    return names


def _python(text: str) -> list[tuple[str, int, int]]:
    found = [
        (node.name, node.lineno, node.end_lineno or node.lineno)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    return sorted(found, key=lambda row: row[1])  # an inner one after the one around it


def _c(text: str) -> list[tuple[str, int, int]]:
    """Functions, which end with a brace in the first column, and macros with arguments."""
    found = []
    for match in _C_BEGIN.finditer(text):
        end = text.find("\n}", match.end())
        found.append((match[1], match.start(), len(text) if end < 0 else end + 1))
    found += [(match[1], match.start(), match.end()) for match in _C_MACRO.finditer(text)]
    return [
        (name, text.count("\n", 0, start) + 1, text.count("\n", 0, end) + 1)
        for name, start, end in found
    ]
