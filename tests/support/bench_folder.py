"""A small benchmark for the tests: seven models of the small recordings, made once a process."""

import atexit
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from unittest import mock

from springpot.host.evidence.benchmark import isolated, picks
from springpot.host.evidence.benchmark.run import Bench, run_bench
from springpot.host.evidence.sweep import Candidate
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import write_recording
from support.peer import CLI
from support.small import press, recording, training

PLAIN = FitOptions()
CANDIDATES = (
    Candidate("rf-fd", PLAIN),
    Candidate("rf-fd", FitOptions(trees=5, leaf=20, engine="fir-fast", round_features=True)),
    Candidate("rbf-fd", PLAIN),
    Candidate("rbf-pv", PLAIN),
    Candidate("hammerstein", FitOptions(poles=4)),
    Candidate("hammerstein", PLAIN, "float64"),
    Candidate("rbf-fd", FitOptions(window_s=1e-3)),  # refused: under ten samples
)


def command(*arguments: str) -> list[str]:
    return [*CLI, *arguments]


def asked(kinds: tuple[str, ...] = ()) -> Bench:
    validation = (
        recording("mixed", press(0.8) + 0.2 * press(0.8)[::-1]),
        recording("other", press(2.0, 0.009)),
    )
    return Bench(training(), validation, "cortex-m4f", kinds=kinds)


def small_sweep(dt_s: float, options: FitOptions, kinds: Sequence[str] = ()) -> list[Candidate]:
    return [item for item in CANDIDATES if not kinds or item.kind in kinds]


@contextmanager
def small(sweep: Callable[..., list[Candidate]] = small_sweep) -> Iterator[None]:
    """Few candidates, timed for a moment, any time allowed: other tests keep the cores busy."""
    with (
        mock.patch("springpot.host.evidence.sweep.default_sweep", sweep),
        mock.patch.object(isolated, "ISOLATED_PACED_S", 0.2),
        mock.patch.object(picks, "PERIOD_SHARE", 1e4),
    ):
        yield


@cache
def bench_folder() -> Path:
    above = tempfile.mkdtemp(prefix="springpot-bench-")
    atexit.register(shutil.rmtree, above)
    folder = Path(above) / "bench"
    with small():
        run_bench(asked(), folder, "springpot bench --recording small")
    return folder


def write_training(folder: Path) -> Path:
    folder.mkdir()
    for item in training():
        write_recording(folder / f"{item.name}.h5", item)
    return folder
