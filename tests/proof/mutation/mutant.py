"""One change of one file."""

from dataclasses import dataclass

# Binary operators of C and of Python, and what each becomes.
OTHER_OPERATORS = {
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
}

_COMPARISONS = {"<", "<=", ">", ">=", "==", "!=", "is", "is not", "in", "not in"}
_OPERATORS = {"&&", "||", "!", "~", "+=", "-=", "*=", "|=", "^=", "++", "--",
              "and", "or", "not", "**", "//", *OTHER_OPERATORS}  # fmt: skip
_NO_STATEMENT = {";", "...", "break", "continue"}


@dataclass(frozen=True)
class Mutant:
    """The text from `start` to `end` (characters) replaced."""

    start: int
    end: int
    new: str

    def kind(self, text: str) -> str:
        """Name what is changed: a comparison, an operator, a statement or a value."""
        old = " ".join(text[self.start : self.end].split())
        if old in _COMPARISONS:
            return "comparison"
        if old in _OPERATORS:
            return "operator"
        return "statement" if self.new in _NO_STATEMENT else "value"

    def apply(self, text: str) -> str:
        return text[: self.start] + self.new + text[self.end :]

    def line_number(self, text: str) -> int:
        return text.count("\n", 0, self.start) + 1

    def lines(self, text: str) -> tuple[str, str]:
        """The lines that it touches, before and after, each as one line without indentation."""
        first = text.rfind("\n", 0, self.start) + 1
        last = text.find("\n", self.end)
        last = len(text) if last < 0 else last
        after = text[first : self.start] + self.new + text[self.end : last]
        return " ".join(text[first:last].split()), " ".join(after.split())
