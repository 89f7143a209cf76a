"""The table of model kinds, and how each is fitted. Nothing heavy loads before a fit."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pkgutil import resolve_name
from typing import TYPE_CHECKING

from springpot.codegen.entry_points import blame_package, load_entries
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.messages import short_repr

if TYPE_CHECKING:
    from springpot.trainer.models.fit import Fit, FitOptions
    from springpot.trainer.models.training_set import TrainingSet
    from springpot.trainer.recordings.recording import Recording


@dataclass(frozen=True)
class Kind:
    """One kind of model.

    name: that of its entry point, and of the models that it fits. fit: "module:function", which
    commands that fit nothing do not load, or the function itself, called with (name, TrainingSet,
    FitOptions, validation recordings) and returning a Fit. mark, colour: of its points in figures.
    place: in lists.
    """

    name: str
    title: str
    fit: "str | Callable[[str, TrainingSet, FitOptions, Sequence[Recording]], Fit]"
    mark: str = "h"
    colour: str = "#444444"
    place: int = 100
    __repr__ = short_repr

    def function(self) -> Callable[..., "Fit"]:
        """Load what `fit` names."""
        if not isinstance(self.fit, str):
            return self.fit
        loaded: Callable[..., Fit] = resolve_name(self.fit)
        return loaded


_MODELS = "springpot.trainer.models"
# Registered in pyproject.toml. A mark and a lightness each: they differ in black and white.
RF_FD = Kind("rf-fd", "the paper's: a forest on fractional derivatives",
             f"{_MODELS}.rf_fd:fit_rf_fd", "o", "#1b6ca8", 0)  # fmt: skip
RBF_FD = Kind("rbf-fd", "the paper's: radial basis functions on two fractional derivatives",
              f"{_MODELS}.rbf:fit_rbf_fd", "s", "#c1121f", 1)  # fmt: skip
RBF_PV = Kind("rbf-pv", "the paper's baseline: radial basis functions on position and velocity",
              f"{_MODELS}.rbf:fit_rbf_pv", "^", "#e09f3e", 2)  # fmt: skip
HAMMERSTEIN = Kind("hammerstein", "springs, Maxwell branches and stops with non-negative weights",
                   f"{_MODELS}.hammerstein:fit_hammerstein", "P", "#2d6a4f", 4)  # fmt: skip
SPRINGPOT = Kind("springpot", "a fractional solid: three or four numbers with intervals",
                 f"{_MODELS}.springpot:fit_springpot", "*", "#6c584c", 7)  # fmt: skip
AUTO = "auto"  # the kind of lowest cross-validated error
_AUTO_FIT_FUNCTION = "springpot.trainer.selection.auto:fit_auto"


def kind_names() -> tuple[str, ...]:
    """List the names that `fit_model` takes.

    >>> "hammerstein" in kind_names()
    True
    """
    return (AUTO, *_kinds())


def fit_model(
    kind: str,
    name: str,
    recordings: "Sequence[Recording]",
    options: "FitOptions",
    validation: "Sequence[Recording]" = (),
) -> "Fit":
    """Fit one model. validation: see `fit_rbf_fd`; other kinds do not look at them.

    recordings: those that `check_recordings` gives as `checked`, or others without spikes.
    Raises UsageError for an unknown kind, DataError where the recordings do not fit together, are
    too short, or show no press or no force of one, SpringpotError where the model misses 30 % of
    the largest force in presses held out or in a training recording.
    """
    from springpot.trainer.models.doubts import (
        judge_residual,
        require_acceptable_misfit,
        require_trainable,
    )
    from springpot.trainer.models.training_set import build_training_set

    kind = _resolve_kind(kind, recordings)
    data = build_training_set(recordings, options.smooth_s)
    require_trainable(data, recordings, kind, options)
    fit = fit_kind(kind, name, data, options, validation)
    require_acceptable_misfit(fit, data, options.accept_misfit)
    return judge_residual(fit, data, recordings, options.accept_misfit)


def _resolve_kind(kind: str, recordings: "Sequence[Recording]") -> str:
    """Return the kind that is fitted: "auto" resolved, and hammerstein alone for several places.

    Raises UsageError for another one, DataError if only some recordings have a place.
    """
    from springpot.trainer.recordings.recording import group_by_site

    sites = group_by_site(recordings)
    if len(sites) < 2:
        return kind
    for recording in recordings:
        if recording.place_m is None:
            raise DataError(
                f"{recording.name}: no place, and others have one: import it with --place X,Y, or "
                "leave it out"
            )
    if kind not in (AUTO, HAMMERSTEIN.name):
        raise UsageError(
            f"{kind}: has no map, and these recordings are of {len(sites)} places: give --model "
            f"{HAMMERSTEIN.name}, or recordings of one place"
        )
    return HAMMERSTEIN.name


def fit_kind(
    kind: str,
    name: str,
    data: "TrainingSet",
    options: "FitOptions",
    validation: "Sequence[Recording]" = (),
) -> "Fit":
    """Fit one kind to a prepared set: `fit_model` for many fits, which share what they can."""
    import scipy.linalg  # noqa: F401  # brings a BLAS of its own, limited only if it is loaded
    from threadpoolctl import threadpool_limits

    from springpot.trainer.models.doubts import find_fit_warnings

    if kind not in kind_names():
        raise UsageError(f"kind {kind!r}: use one of {', '.join(kind_names())}")
    if options.past_positions and kind != RF_FD.name:
        raise UsageError(f"--past-positions: a control of {RF_FD.name}, not of {kind}")
    # The matrices are small: more threads of BLAS wait for each other, ten times longer on a
    # machine that has other work.
    with threadpool_limits(1, user_api="blas"):
        if kind == AUTO:
            fit: Fit = resolve_name(_AUTO_FIT_FUNCTION)(name, data, options, validation)
        else:
            fit = _fit_entry_point(kind, name, data, options, validation)
    warnings = dict.fromkeys(
        (*data.warnings, *fit.warnings, *find_fit_warnings(fit, data, options))
    )
    return replace(fit, warnings=tuple(warnings))


def _fit_entry_point(
    entry: str,
    name: str,
    data: "TrainingSet",
    options: "FitOptions",
    validation: "Sequence[Recording]",
) -> "Fit":
    """Fit as one kind does. Raises UsageError if the fit of another package's kind fails."""
    from springpot.trainer.models.fit import Fit

    kind = _kinds()[entry]
    with blame_package(f"kind {entry!r}", kind.fit, UsageError):
        _check_name("Kind", kind.name, entry)
        fit = kind.function()(name, data, options, validation)
        if not isinstance(fit, Fit):
            raise TypeError("its fit returns no Fit")
        _check_name("its model", fit.model.kind, entry)
        return fit


def _check_name(what: str, name: str, entry: str) -> None:
    """Raise TypeError for a name by which commands would look for a kind that is not there."""
    if name != entry:
        raise TypeError(f"{what} has the name {name!r}: give that of its entry point")


KINDS: dict[str, Kind]  # entry points of the group springpot.kinds, by name


@cache
def _kinds() -> dict[str, Kind]:
    """Load them when they are first asked for: a package whose device is loaded imports `Kind`."""
    return load_entries("kinds", Kind)


def __getattr__(name: str) -> object:
    if name != "KINDS":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _kinds()
