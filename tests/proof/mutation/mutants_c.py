"""All single changes of a C text: comparisons, logic, signs, arithmetic, constants, assignments.

Token by token, since comments and macros are to stay as they are: what makes no C is found by the
compiler, and is not counted.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

_TOKEN = re.compile(
    r"""(?P<blank>\s+|\\\n|//[^\n]*|/\*.*?\*/)
      |(?P<directive>^[ \t]*\#[ \t]*define[ \t]+\w+(\([^)]*\))?|^[ \t]*\#(\\\n|[^\n])*)
      |(?P<text>"(\\.|[^"\\])*"|'(\\.|[^'\\])*')
      |(?P<number>0[xX][0-9a-fA-F]+[uUlL]*|(\d+\.\d*|\.\d+|\d+)([eE][+-]?\d+)?[fFuUlL]*)
      |(?P<name>[A-Za-z_]\w*)
      |(?P<sign><<=|>>=|\.\.\.|\#\#|->|\+\+|--|&&|\|\||<<|>>|[-+*/%&|^=!<>]=|[^\w\s])""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)

# Binary operators, and what each becomes.
_BINARY = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "+": ("-",),
    "-": ("+",),
    "*": ("/",),
    "/": ("*",),
    "%": ("*",),
    "<<": (">>",),
    ">>": ("<<",),
    "&": ("|",),
    "|": ("&",),
    "^": ("|",),
    "&&": ("||",),
    "||": ("&&",),
    "+=": ("-=", "="),
    "-=": ("+=", "="),
    "*=": ("/=", "="),
    "|=": ("&=", "="),
    "^=": ("|=", "="),
    "++": ("--",),
    "--": ("++",),
}
_UNARY = {"-", "!", "~"}
_CONSTANT = re.compile(r"[A-Z][A-Z0-9_]{2,}")
_HEADS = {"if", "for", "while", "else", "do", "switch", "case", "default", "typedef", "struct",
          "union", "enum", "extern"}  # fmt: skip
_OPEN, _CLOSED = "([{", ")]}"


@dataclass(frozen=True)
class Mutant:
    """The text from `start` to `end` (characters) replaced."""

    start: int
    end: int
    new: str

    def apply(self, text: str) -> str:
        return text[: self.start] + self.new + text[self.end :]

    def lines(self, text: str) -> tuple[str, str]:
        """The lines that it touches, before and after, each as one line without indentation."""
        first = text.rfind("\n", 0, self.start) + 1
        last = text.find("\n", self.end)
        last = len(text) if last < 0 else last
        after = text[first : self.start] + self.new + text[self.end : last]
        return " ".join(text[first:last].split()), " ".join(after.split())


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    start: int
    end: int


def _tokens(text: str) -> list[_Token]:
    return [
        _Token(match.lastgroup, match[0], match.start(), match.end())
        for match in _TOKEN.finditer(text)
        if match.lastgroup and match.lastgroup != "blank"
    ]


def mutants_of_c(text: str) -> Iterator[Mutant]:
    """Every single change of a C text, in order, each once."""
    yield from dict.fromkeys(_changes(text))


def _changes(text: str) -> Iterator[Mutant]:
    tokens = _tokens(text)
    for at, token in enumerate(tokens):
        before = tokens[at - 1] if at else None
        yield from (Mutant(token.start, token.end, new) for new in _replacements(tokens, at))
        if token.text == "=":
            yield from _without_value(tokens, at)
        if before is None or before.text in ";{}":
            yield from _without_statement(tokens, at)
        if token.text == "return":
            yield from _without_value(tokens, at)
        if token.text == "if":
            yield from _negated(tokens, at + 1)


def _replacements(tokens: list[_Token], at: int) -> Iterator[str]:
    token = tokens[at]
    if token.kind == "number":
        yield from _other_numbers(token.text)
    elif token.kind == "name" and _CONSTANT.fullmatch(token.text) and token.text != "NULL":
        neighbours = {near.text for near in tokens[max(at - 1, 0) : at + 2]}
        if "##" not in neighbours and tokens[at + 1].text not in ("(", "="):
            yield f"({token.text} + 1)"
    elif token.kind == "sign" and at > 0:
        is_binary = tokens[at - 1].kind != "sign" or tokens[at - 1].text in ")]"
        is_binary = is_binary and tokens[at - 1].text != "return"
        if is_binary or token.text in ("++", "--"):
            yield from _BINARY.get(token.text, ())
        elif token.text in _UNARY:
            yield ""
        if is_binary and token.text == "-" and tokens[at - 1].text == ")":
            yield ""  # (type)-value


def _other_numbers(text: str) -> Iterator[str]:
    is_hex = text[:2] in ("0x", "0X")
    digits = text.rstrip("uUlL" if is_hex else "uUlLfF")
    ending = text[len(digits) :]
    if is_hex:
        yield f"{int(digits, 16) ^ 1:#x}{ending}"
    elif re.search(r"[.eE]", digits):
        yield f"(2 * {text})" if float(digits) else f"1.0{ending}"
        if float(digits):
            yield f"(0.5 * {text})"
    else:
        yield f"{int(digits) + 1}{ending}"
        if int(digits) > 0:
            yield f"{int(digits) - 1}{ending}"


def _end_of(tokens: list[_Token], at: int, ends: str) -> int | None:
    """Where, from `at` on, one of `ends` closes what is open there."""
    depth = 0
    for k in range(at, len(tokens)):
        text = tokens[k].text
        if depth == 0 and text in ends:
            return k
        depth += (text in _OPEN) - (text in _CLOSED)
        if depth < 0 or tokens[k].kind == "directive":
            return None
    return None


def _without_value(tokens: list[_Token], at: int) -> Iterator[Mutant]:
    """`= value` or `return value` with 0 for the value."""
    end = _end_of(tokens, at + 1, ";,}")
    if end is None or end == at + 1:
        return
    value = [token.text for token in tokens[at + 1 : end]]
    if "{" not in value and value[-1] != "0":
        yield Mutant(tokens[at + 1].start, tokens[end - 1].end, "0")


def _without_statement(tokens: list[_Token], at: int) -> Iterator[Mutant]:
    """An assignment, a call, a `break` that is not there."""
    end = _end_of(tokens, at, ";")
    if tokens[at].text in _HEADS or tokens[at].kind == "directive" or end is None or end == at:
        return
    if tokens[at].text == "return" and end > at + 1:
        return  # what it gives instead is not defined
    statement = {token.text for token in tokens[at:end]}
    if "{" not in statement:
        yield Mutant(tokens[at].start, tokens[end].end, ";")


def _negated(tokens: list[_Token], at: int) -> Iterator[Mutant]:
    """`if (flag)` turned round; comparisons are turned round by themselves."""
    end = _end_of(tokens, at + 1, ")")
    if end is not None and not any(token.text in _BINARY for token in tokens[at + 1 : end]):
        text = " ".join(token.text for token in tokens[at : end + 1])
        yield Mutant(tokens[at].start, tokens[end].end, f"(!{text})")
