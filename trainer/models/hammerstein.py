"""Kind `hammerstein`, the passive model, which every other kind falls back to."""

import time
from collections.abc import Sequence

import numpy as np

from springpot.codegen.types import JsonObject
from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.passive.map_fit import fit_map
from springpot.trainer.models.passive.passive_fit import fit_passive_timed
from springpot.trainer.models.passive.start import select_start
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording, group_by_site


def fit_hammerstein(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Kind `hammerstein`: some hundred numbers, passive in the large; a map of several places."""
    begin, map_metadata = time.perf_counter(), JsonObject()
    if len(group_by_site(data.recordings)) > 1:
        map_fit = fit_map(data, options)
        passive, rows, error_n, law = map_fit.model, map_fit.rows, map_fit.error_n, map_fit.law
        assert passive.places is not None
        map_metadata = {"places": map_fit.sites, "materials": len(passive.places.slopes_n)}
        fit_s = time.perf_counter() - begin
    else:
        data = select_start(data, options)
        start_s = time.perf_counter() - begin
        passive, choice, passive_s = fit_passive_timed(data, options)
        rows, error_n, law = len(choice.rows.rows), choice.error_n, choice.law
        fit_s = start_s + passive_s
    metadata = {
        # Numbers that the C keeps: slopes above 0, forces of flowing branches, and the bias.
        "n_parameters": int(np.count_nonzero(passive.slopes_n)) + (passive.bias_n != 0.0),
        "cv_rmse_n": error_n,
        "law": " and ".join(law) or "plain",
        "nodes": passive.nodes,
        "rate_ratio": passive.rate_ratio,
        "recovers": passive.recovers,
        "starts_conditioned": passive.continues,
        "sessions": sum(len(motion.recordings) > 1 for motion in data.motions),
        **map_metadata,
    }
    model = assemble(
        "hammerstein", name, data, options, rows, (None, None), passive, True, metadata
    )
    return Fit(model, rows, feature_s=0.0, fit_s=fit_s, metadata=metadata)
