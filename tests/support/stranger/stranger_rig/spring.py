"""The kind of model `spring`: an elastic curve, without memory."""

from collections.abc import Sequence
from dataclasses import replace

from springpot import Fit, Recording
from springpot.trainer.models.fit import FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import fit_passive_timed
from springpot.trainer.models.training_set import TrainingSet


def fit_spring(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Keep the curve of the passive model, and nothing that relaxes."""
    passive, choice, fit_s = fit_passive_timed(data, options)
    rows = len(choice.rows.rows)
    spring = replace(
        passive, tau_s=passive.tau_s[:0], branch_n=passive.branch_n[:0], n_by_depth=0, flow=None,
        radius_m=passive.radius_m[:0], stop_n=passive.stop_n[:0], damage=None, end_memory=None,
    )  # fmt: skip
    model = assemble("spring", name, data, options, rows, (None, None), spring, True, {})
    return Fit(model, rows, 0.0, fit_s)
