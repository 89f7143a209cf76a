"""C text: out of templates, and in blocks, so that functions that nothing calls are left out.

A block is what stands between blank lines outside braces: a definition with the comment above it.
"""

import re
from collections.abc import Callable, Iterator, Sequence
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
# What a block defines for this file alone: tables and constants, functions, enumerators.
_FILE_SCOPE = (
    (re.compile(r"^static const [\w ]+?\b(\w+)(?:\[[^\]]*\])* = ", re.MULTILINE), "sp_scene_"),
    (re.compile(r"^(?:static|SP_[A-Z]+) [\w *]*?\b(\w+)\([^;{]*\)\s*\{", re.MULTILINE), "sp_"),
    (re.compile(r"^ +(N_\w+) = ", re.MULTILINE), "SP_SCENE_"),
)
_MACRO = re.compile(r"#define (\w+)")
COLUMNS = 100  # of a line of emitted C
_BREAK = re.compile(r"(?:,|=|\+|-|\?|:|&&|\|\||[=!<>]=) ")
_CONTINUES = re.compile(r"(?:[,(=+?:-]|&&|\|\|)$")
_NO_STATEMENT = re.compile(r'"|/\*|^ \*|^#|\\$')
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
    """Return True if a stage's template has that block."""
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
    """Return the text without comments and strings, line by line."""
    return _NOT_CODE.sub(lambda found: "\n" * found[0].count("\n"), text)


def scope_to_scene(blocks: Sequence[str]) -> list[str]:
    """Give what the blocks define for this file alone names that carry the scene's prefix.

    So that two scenes compile in one unit. Comments and members of structs are not touched.
    """
    renamed: dict[str, str] = {}
    for code in map(strip_comments, blocks):
        for pattern, prefix in _FILE_SCOPE:
            unprefixed = (
                name for name in pattern.findall(code) if not name.startswith(("sp_", "SP_"))
            )
            renamed |= {name: prefix + name for name in unprefixed}
    if not renamed:
        return list(blocks)
    used = re.compile(rf"(?<![\w.])(?<!->)({'|'.join(map(re.escape, renamed))})\b")
    return [
        _change_code(block, lambda code: used.sub(lambda name: renamed[name[1]], code))
        for block in blocks
    ]


def _change_code(text: str, change: Callable[[str], str]) -> str:
    """Change a text outside its comments and strings."""
    parts, end = [], 0
    for prose in _NOT_CODE.finditer(text):
        parts += [change(text[end : prose.start()]), prose[0]]
        end = prose.end()
    return "".join([*parts, change(text[end:])])


def wrap_code(text: str) -> str:
    """Break statements that have a line of more than 100 columns: a scene's names lengthen them.

    Continued lines are aligned to the innermost bracket. Comments, strings and macros stay.
    """
    wrapped, statement = list[str](), list[str]()
    for line in text.split("\n"):
        statement.append(line)
        if _CONTINUES.search(line):
            continue
        long = any(len(part) > COLUMNS for part in statement)
        prose = any(_NO_STATEMENT.search(part) for part in statement)
        wrapped += _wrap_statement(statement) if long and not prose else statement
        statement = []
    return "\n".join([*wrapped, *statement])


def _wrap_statement(lines: Sequence[str]) -> Iterator[str]:
    """Break a statement at its commas and operators into lines of at most 100 columns."""
    indent = len(lines[0]) - len(lines[0].lstrip())
    rest = " " * indent + " ".join(line.strip() for line in lines).replace("( ", "(")
    aligned = [indent + 4]  # column at which a line goes on, one for each open bracket
    while len(rest) > COLUMNS:
        ends = [mark.end() for mark in _BREAK.finditer(rest, 0, COLUMNS + 1)]
        if not ends or ends[-1] <= aligned[-1]:
            break
        line, rest = rest[: ends[-1]].rstrip(), rest[ends[-1] :]
        for column, mark in enumerate(line):
            if mark == "(":
                aligned.append(column + 1)
            elif mark == ")":
                aligned.pop()
        yield line
        rest = " " * aligned[-1] + rest
    yield rest


def drop_unused(blocks: Sequence[str]) -> list[str]:
    """Leave out the functions and macros of this file that no other block uses.

    One that stands among directives of the preprocessor stays.
    """
    used = list(blocks)
    while True:
        words = [set(re.findall(r"\w+", strip_comments(block))) for block in used]
        unused = [
            i
            for i, block in enumerate(used)
            if (names := _private_names(block))
            and not any(names & other for k, other in enumerate(words) if k != i)
        ]
        if not unused:
            return used
        used = [block for i, block in enumerate(used) if i not in unused]


def _private_names(block: str) -> set[str]:
    """Return names of the static function or of the macros that a block defines; of others none."""
    code = strip_comments(block).strip()
    macros = [_MACRO.match(line) for line in code.splitlines()]
    if all(macros):
        return {macro[1] for macro in macros if macro}
    if not code.startswith(_STATIC_STARTS) or _DIRECTIVE.search(code):
        return set()
    function = _FUNCTION.match(code)
    return {function[1]} if function else set()
