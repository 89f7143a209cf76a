"""C text: out of templates, and in blocks, so that functions that nothing calls are left out.

A block is what stands between blank lines outside braces: a definition with the comment above it.
"""

import re
from collections.abc import Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from springpot.codegen.literals import c_literal
from springpot.codegen.stages.stage import RegressorStage, Stage

_TEMPLATES = Environment(
    loader=PackageLoader("springpot.codegen.emit", "templates"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)
_NOT_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)
_FUNCTION = re.compile(r"(?:[A-Z]\w* )?(?:static )?(?:inline )?[\w *]*?\b(\w+)\([^;{]*\)\s*\{")
_STATIC_STARTS = ("static ", "SP_")  # what a function begins with that no other file sees
_DIRECTIVE = re.compile(r"^#(?!pragma)", re.MULTILINE)


def render_template(template: str, **context: Any) -> str:
    """Fill in a file of codegen/emit/templates."""
    return _TEMPLATES.get_template(template).render(literal=c_literal, **context)


def render_block(stage: Stage | RegressorStage, block: str) -> str:
    """Fill in one block of a stage's own template: lines of C, without the last line's end."""
    template = _compile(stage.code)
    context = template.new_context({"stage": stage, "literal": c_literal})
    return "".join(template.blocks[block](context)).rstrip("\n")


def has_block(stage: Stage | RegressorStage, block: str) -> bool:
    """Whether a stage's template has that block."""
    return block in _compile(stage.code).blocks


@cache
def _compile(code: str) -> Template:
    """A template is compiled once: that takes longer than all else of an emission."""
    return _TEMPLATES.from_string(code)


def split_blocks(text: str) -> list[str]:
    """Cut a text into its blocks, in order."""
    blocks, block, depth = [], list[str](), 0
    for line, code in zip(text.split("\n"), strip_comments(text).split("\n"), strict=True):
        if line or depth:
            block.append(line)
        elif block:
            blocks.append("\n".join(block))
            block = []
        depth += code.count("{") - code.count("}")
    return [*blocks, "\n".join(block)] if block else blocks


def strip_comments(text: str) -> str:
    """The text without comments and strings, line by line."""
    return _NOT_CODE.sub(lambda found: "\n" * found[0].count("\n"), text)


def drop_unused_functions(found: Sequence[str]) -> list[str]:
    """Leave out the functions of this file that no other block calls.

    One that stands among directives of the preprocessor stays.
    """
    used = list(found)
    while True:
        words = [set(re.findall(r"\w+", strip_comments(block))) for block in used]
        unused = [
            i
            for i, block in enumerate(used)
            if (name := _static_function(block)) is not None
            and not any(name in other for k, other in enumerate(words) if k != i)
        ]
        if not unused:
            return used
        used = [block for i, block in enumerate(used) if i not in unused]


def _static_function(block: str) -> str | None:
    """Name of the static function that a block defines; None for others, or with a directive."""
    code = strip_comments(block).strip()
    if not code.startswith(_STATIC_STARTS) or _DIRECTIVE.search(code):
        return None
    found = _FUNCTION.match(code)
    return found[1] if found else None
