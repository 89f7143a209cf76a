"""A finding: one line that says what, where, so what, and what to do."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import partial
from typing import Literal

from springpot.codegen.errors import DataError, in_python


@dataclass(frozen=True)
class Finding:
    """kind: short name for programs. A refusal means that no model can be made of this."""

    severity: Literal["refusal", "warning"]
    kind: str
    where: str
    what: str
    so_what: str
    to_do: str

    @property
    def line(self) -> str:
        return f"{self.severity}: {self.text}"

    @property
    def text(self) -> str:
        """The line without its severity."""
        return in_python(f"{self.where}: {self.what}: {self.so_what}; {self.to_do}")

    def metadata(self) -> dict[str, str]:
        return asdict(self) | {"line": self.line}


def join_refusals(texts: Iterable[str]) -> DataError:
    """One error of all refusals, each said once."""
    return DataError("; also ".join(dict.fromkeys(texts)))


refusal = partial(Finding, "refusal")
warning = partial(Finding, "warning")


def format_si(value: float, unit: str) -> str:
    """Write a value with a prefix of its unit.

    >>> three_digits(9.996e-4, "m"), three_digits(7850.0, "N/m")
    ('1 mm', '7.85 kN/m')
    """
    rounded = float(f"{value:.3g}")
    for scale, prefix in ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n")):
        if abs(rounded) >= scale:
            return f"{rounded / scale:.3g} {prefix}{unit}"
    return f"{rounded:.3g} {unit}"
