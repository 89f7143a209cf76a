"""C text: out of templates, and in blocks, so that functions that nothing calls are left out.

A block is what stands between blank lines outside braces: a definition with the comment above it.
"""

import re
from collections.abc import Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from springpot.codegen.literals import literal
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
_OWN = ("static ", "SP_")  # what a function begins with that no other file sees
_DIRECTIVE = re.compile(r"^#(?!pragma)", re.MULTILINE)


def rendered(template: str, **context: Any) -> str:
    """Fill in a file of codegen/emit/templates."""
    return _TEMPLATES.get_template(template).render(literal=literal, **context)


def block_text(stage: Stage | RegressorStage, block: str) -> str:
    """Fill in one block of a stage's own template: lines of C, without the last line's end."""
    template = _compiled(stage.code)
    context = template.new_context({"stage": stage, "literal": literal})
    return "".join(template.blocks[block](context)).rstrip("\n")


def has_block(stage: Stage | RegressorStage, block: str) -> bool:
    """Whether a stage's template has that block."""
    return block in _compiled(stage.code).blocks


@cache
def _compiled(code: str) -> Template:
    """A template is compiled once: that takes longer than all else of an emission."""
    return _TEMPLATES.from_string(code)


def top_level_blocks(text: str) -> list[str]:
    """Cut a text into its blocks, in order."""
    found, block, depth = [], list[str](), 0
    for line, code in zip(text.split("\n"), code_of(text).split("\n"), strict=True):
        if line or depth:
            block.append(line)
        elif block:
            found.append("\n".join(block))
            block = []
        depth += code.count("{") - code.count("}")
    return [*found, "\n".join(block)] if block else found


def code_of(text: str) -> str:
    """The text without comments and strings, line by line."""
    return _NOT_CODE.sub(lambda found: "\n" * found[0].count("\n"), text)


def without_unused(found: Sequence[str]) -> list[str]:
    """Leave out the functions of this file that no other block calls.

    One that stands among directives of the preprocessor stays.
    """
    used = list(found)
    while True:
        words = [set(re.findall(r"\w+", code_of(block))) for block in used]
        unused = [
            i
            for i, block in enumerate(used)
            if (name := _own_function(block)) is not None
            and not any(name in other for k, other in enumerate(words) if k != i)
        ]
        if not unused:
            return used
        used = [block for i, block in enumerate(used) if i not in unused]


def _own_function(block: str) -> str | None:
    """Name of the static function that a block defines; None for others, or with a directive."""
    code = code_of(block).strip()
    if not code.startswith(_OWN) or _DIRECTIVE.search(code):
        return None
    found = _FUNCTION.match(code)
    return found[1] if found else None
