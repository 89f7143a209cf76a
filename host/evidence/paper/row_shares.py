"""How much of the recorded data the paper's models need: error and time against the rows used."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator, ScalarFormatter

from springpot.codegen.arrays import Indices, rms
from springpot.codegen.model.features import Features
from springpot.codegen.model.regressors import Regressor
from springpot.host.evidence.paper.figures import COLORS, PAPER_LINES, PAPER_STYLE, save
from springpot.host.evidence.paper.reproduce import PAPER_KINDS, ObjectResult, Work
from springpot.host.pages.plot_style import MUTED

PAPER_SHARE = 0.2
_SHARES = (0.05, 0.1, PAPER_SHARE, 1.0)
_EVERY = 10  # samples of a validation recording: its RMSE needs no more


@dataclass(frozen=True)
class RowShare:
    """Models fitted on a share of the training rows.

    By kind: RMSE averaged over the validation recordings, N; features and training, s.
    """

    share: float
    rows: int
    rmse_n: Mapping[str, float]
    modelling_s: Mapping[str, float]


@dataclass(frozen=True)
class RowShares:
    """All shares of one object, the smallest first; the last is all rows."""

    name: str
    shares: tuple[RowShare, ...]

    @property
    def paper(self) -> RowShare:
        """The share that the paper used."""
        return next(item for item in self.shares if item.share == PAPER_SHARE)

    def as_dict(self) -> dict[str, Any]:
        return {"object": self.name, "shares": [dict(vars(item)) for item in self.shares]}


def row_shares(result: ObjectResult, work: Work) -> RowShares:
    """Fit the paper's kinds again, with the features that they have, on more and fewer rows."""
    from threadpoolctl import threadpool_limits

    from springpot.trainer.features.values import feature_values
    from springpot.trainer.models.contact import depth_m
    from springpot.trainer.models.fit import FitOptions
    from springpot.trainer.models.forests import depth_scale, fit_forest
    from springpot.trainer.models.predict import regressor_force
    from springpot.trainer.models.radial import fit_rbf
    from springpot.trainer.models.training_set import training_set

    options = FitOptions(trees=work.trees)
    data = result.data
    prepared = training_set(data.training, options.smooth_s)
    scale = depth_scale(prepared.trained.max_m - min(prepared.trained.min_m, 0.0))

    features: dict[str, Features] = {}
    for kind in PAPER_KINDS:
        of_kind = result.models[kind].fit.model.features
        assert of_kind is not None, "the paper's kinds have features"
        features[kind] = of_kind

    def fitted(kind: str, rows: Indices) -> tuple[Regressor, float]:
        begin = time.perf_counter()
        values, force_n = prepared.features(features[kind], rows), prepared.force_n(rows)
        regressor: Regressor
        if kind == "rf-fd":
            regressor, _ = fit_forest(values, force_n, scale, options.trees, options.leaf, 0)
        else:
            regressor, _ = fit_rbf(values, force_n, options.n_centers, options.centers)
        return regressor, time.perf_counter() - begin

    def rmse_n(kind: str, regressor: Regressor) -> float:
        errors = []
        for recording in data.validation:
            at = np.arange(0, len(recording.force_n), _EVERY)
            depth = depth_m(recording, prepared.contact)
            values = feature_values(features[kind], depth, prepared.dt_s, at)
            errors.append(rms(regressor_force(regressor, values) - recording.force_n[at]))
        return float(np.mean(errors))

    found = []
    for share in _SHARES:
        rows = prepared.rows(share, options.seed)
        with threadpool_limits(1, user_api="blas"):  # as `fit_kind` does
            again = {kind: fitted(kind, rows) for kind in PAPER_KINDS}
        errors = {kind: rmse_n(kind, regressor) for kind, (regressor, _) in again.items()}
        seconds = {kind: modelling_s for kind, (_, modelling_s) in again.items()}
        found.append(RowShare(share, len(rows), errors, seconds))
    return RowShares(data.name, tuple(found))


def rows_figure(found: RowShares, out: Path, data: str) -> list[str]:
    """Draw error and modelling time against the share of rows into `out`."""
    share = [100.0 * item.share for item in found.shares]
    with mpl.rc_context(PAPER_STYLE):
        figure = Figure(figsize=(7.5, 3.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        for kind in PAPER_KINDS:
            style: Any = {"color": COLORS[kind], "ls": PAPER_LINES[kind], "marker": "o", "ms": 3.0}
            left.plot(share, [item.rmse_n[kind] for item in found.shares], label=kind, **style)
            right.plot(share, [item.modelling_s[kind] for item in found.shares], **style)
        left.set_ylim(0.0)
        right.set_yscale("log")
        for axes, label in ((left, "RMSE, N"), (right, "modelling time, s")):
            axes.axvline(100.0 * PAPER_SHARE, color=MUTED, lw=0.7, ls=":")
            axes.set_xscale("log")
            axes.set_xticks(share)
            axes.xaxis.set_major_formatter(ScalarFormatter())
            axes.xaxis.set_minor_locator(NullLocator())
            axes.set_xlabel("rows used, %")
            axes.set_ylabel(label)
        left.legend(frameon=False, loc="lower right")
        caption = (
            f"Error and modelling time of {found.name} against the share of its rows; dotted: the "
            f"paper's 20 %. {data}"
        )
        return save(figure, out, "figure-rows", caption)
