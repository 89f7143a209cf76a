"""What the benchmark measures: kinds x sizes x filter engines and windows x number types."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from springpot.codegen.scene import Number
from springpot.trainer.kinds import KINDS
from springpot.trainer.models.fit import PAPER_CENTERS, FitOptions
from springpot.trainer.models.rf_fd import PAPER_TAPS

_CENTERS = (10, 20, 30, 60, PAPER_CENTERS, 200, 300)


@dataclass(frozen=True)
class Candidate:
    """One model: its kind and options to fit it with, or its file; the number type of its C."""

    kind: str
    options: FitOptions
    number: Number = "float32"
    file: Path | None = None

    def named_options(self) -> dict[str, object]:
        """Return options that differ from the defaults."""
        plain = asdict(FitOptions())
        named: dict[str, object] = {
            name: value for name, value in asdict(self.options).items() if value != plain[name]
        }
        return named | ({"number": self.number} if self.number != "float32" else {})


def default_sweep(dt_s: float, options: FitOptions, kinds: Sequence[str] = ()) -> list[Candidate]:
    """List every candidate of `kinds` (all by default); windows are in samples of dt_s.

    The paper's three models are among them: rf-fd, rbf-fd and rbf-pv with nothing named.
    """
    found = [*_forests(dt_s, options), *_functions(options), *_passive(options)]
    swept = {candidate.kind for candidate in found}
    found += [Candidate(kind, options) for kind in KINDS if kind not in swept]
    return [candidate for candidate in found if not kinds or candidate.kind in kinds]


def _forests(dt_s: float, options: FitOptions) -> Iterator[Candidate]:
    for leaf, counts in ((5, (5, 10, 20, 50, 100, 200, 300)), (20, (5, 10, 20, 50, 100))):
        for trees in counts:
            yield Candidate("rf-fd", replace(options, trees=trees, leaf=leaf))
    fast = replace(options, engine="fir-fast", round_features=True)
    for leaf in (5, 20):
        for trees in (5, 10, 30, 100):
            yield Candidate("rf-fd", replace(fast, trees=trees, leaf=leaf))
    small = replace(fast, trees=30, leaf=20)
    for length in (PAPER_TAPS // 4, 2 * PAPER_TAPS, 4 * PAPER_TAPS):
        yield Candidate("rf-fd", replace(small, window_s=length * dt_s))
    for window_s in (20 * PAPER_TAPS * dt_s, None):
        yield Candidate("rf-fd", replace(small, engine="recursive", window_s=window_s))
    yield Candidate("rf-fd", options, "float64")
    yield Candidate("rf-fd", replace(options, trees=30, leaf=20, past_positions=True))


def _functions(options: FitOptions) -> Iterator[Candidate]:
    for n_centers in _CENTERS:
        yield Candidate("rbf-fd", replace(options, n_centers=n_centers))
        yield Candidate("rbf-pv", replace(options, n_centers=n_centers))
    for engine in ("fir-fast", "recursive"):
        for n_centers in (30, PAPER_CENTERS):
            yield Candidate("rbf-fd", replace(options, n_centers=n_centers, engine=engine))
    yield Candidate("rbf-fd", options, "float64")


def _passive(options: FitOptions) -> Iterator[Candidate]:
    for poles in (2, 4, 6, 8, 12, 16):
        yield Candidate("hammerstein", replace(options, poles=poles))
    yield Candidate("hammerstein", options, "float64")
    yield Candidate("springpot", options)
