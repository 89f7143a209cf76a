"""Kinds of models by name, and how each is fitted."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from threadpoolctl import threadpool_limits

from springpot.codegen.errors import UsageError
from springpot.trainer.models.fit import Fit, FitOptions
from springpot.trainer.models.hammerstein import fit_hammerstein, fit_hybrid
from springpot.trainer.models.rbf import fit_rbf_fd, fit_rbf_pv
from springpot.trainer.models.rf_fd import fit_boosted_fd, fit_rf_fd, fit_rf_history
from springpot.trainer.models.springpot import fit_springpot
from springpot.trainer.models.training_set import TrainingSet, training_set
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.selection.auto import fit_auto

WINDOWS = 3  # recordings shorter than this many windows cannot teach what the window holds

_FITS: dict[str, Callable[[str, TrainingSet, FitOptions], Fit]] = {
    "rf-fd": fit_rf_fd,
    "rbf-fd": fit_rbf_fd,
    "rbf-pv": fit_rbf_pv,
    "rf-history": fit_rf_history,
    "hammerstein": fit_hammerstein,
    "hybrid": fit_hybrid,
    "boosted": fit_boosted_fd,
    "auto": fit_auto,
    "springpot": fit_springpot,
}


def kind_names() -> tuple[str, ...]:
    """All kinds."""
    return tuple(_FITS)


def fit_model(
    kind: str,
    name: str,
    recordings: Sequence[Recording],
    options: FitOptions,
    validation: Sequence[Recording] = (),
) -> Fit:
    """Fit one model. `validation` decides only for rbf-fd with select "paper".

    Raises DataError where the recordings do not fit together.
    """
    return fit_kind(kind, name, training_set(recordings, options.smooth_s), options, validation)


def fit_kind(
    kind: str,
    name: str,
    data: TrainingSet,
    options: FitOptions,
    validation: Sequence[Recording] = (),
) -> Fit:
    """The same on recordings that are prepared: many fits on one set share what they can."""
    if options.within is not None and kind != "rf-fd":
        raise UsageError(f"--within trims rf-fd; {kind} has no trees to leave out")
    # The matrices are small: more threads of BLAS wait for each other, ten times longer on a
    # machine that has other work.
    with threadpool_limits(1, user_api="blas"):
        if options.within is not None:
            return _trimmed(name, data, options, validation)
        if kind == "rbf-fd":
            fit = fit_rbf_fd(name, data, options, validation)
        else:
            fit = _FITS[kind](name, data, options)
    return replace(fit, warnings=(*fit.warnings, *_short_recordings(data, options)))


def _trimmed(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording]
) -> Fit:
    from springpot.trainer.selection.reduce import trimmed_options

    begin = time.perf_counter()
    search = trimmed_options(data, options, options.within or 0.0, validation)
    search_s = time.perf_counter() - begin
    fit = fit_rf_fd(name, data, search.options)
    return replace(fit, search_s=search_s, facts={**fit.facts, **search.facts()})


def _short_recordings(data: TrainingSet, options: FitOptions) -> tuple[str, ...]:
    window_s = options.window_s
    if window_s is None or data.longest_s >= WINDOWS * window_s:
        return ()
    return (
        f"--window-s {window_s:g}: the longest recording lasts {data.longest_s:.3g} s, under "
        f"{WINDOWS} windows: memory that long is guessed, not learned; record longer holds",
    )
