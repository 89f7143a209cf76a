"""Signatures of the Python interface as the source has them: `ArrayLike`, not its meaning."""

import ast
import dataclasses
import inspect
import textwrap
from typing import Any


def as_written(
    _app: Any, what: str, _name: str, found: Any, _options: Any, _signature: Any, _returns: Any
) -> tuple[str, str | None] | None:
    """Sphinx's autodoc-process-signature: arguments, and what is returned."""
    if what == "class":
        return _of_class(found), None
    if what in ("function", "method"):
        return _of_function(found)
    return None


def _of_class(found: type) -> str:
    """Fields with their defaults; their types stand in the class's own text."""
    if dataclasses.is_dataclass(found):
        names = [_with_default(field) for field in dataclasses.fields(found) if field.init]
        return f"({', '.join(names)})"
    if "__init__" in vars(found):
        return _of_function(vars(found)["__init__"])[0]
    return ""


def _with_default(field: "dataclasses.Field[Any]") -> str:
    if field.default is not dataclasses.MISSING:
        return f"{field.name}={field.default!r}"
    made = field.default_factory is not dataclasses.MISSING
    return f"{field.name}=..." if made else field.name


def _of_function(found: Any) -> tuple[str, str | None]:
    (node,) = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(found)))).body
    assert isinstance(node, ast.FunctionDef)
    arguments = node.args
    positional = [*arguments.posonlyargs, *arguments.args]
    if positional and positional[0].arg in ("self", "cls"):
        (arguments.posonlyargs or arguments.args).pop(0)
    for argument in (*positional, *arguments.kwonlyargs):
        argument.annotation = _bare(argument.annotation)
    values = inspect.signature(found).parameters
    arguments.kw_defaults = [  # FitOptions.seed is shown as 0
        ast.Constant(values[argument.arg].default)
        if isinstance(default, ast.Attribute)
        else default
        for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    ]
    returns = _bare(node.returns)
    return f"({ast.unparse(arguments)})", ast.unparse(returns) if returns else None


def _bare(annotation: ast.expr | None) -> ast.expr | None:
    """An annotation in quotes, without them."""
    match annotation:
        case ast.Constant(value=str(text)):
            return ast.parse(text, mode="eval").body
    return annotation
