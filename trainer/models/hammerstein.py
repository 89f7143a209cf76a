"""Kind `hammerstein`, the passive model, which every other kind falls back to."""

from collections.abc import Sequence

from springpot.trainer.models.fit import Fit, FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import passive_choice, timed_passive
from springpot.trainer.models.passive.passive_terms import parameter_count
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Recording


def fit_hammerstein(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    """Kind `hammerstein`: some hundred numbers, passive in the large."""
    (passive, rows, error_n), fit_s = timed_passive(data, options)
    metadata = {
        "n_parameters": parameter_count(passive),
        "cv_rmse_n": error_n,
        "law": " and ".join(passive_choice(data, options)[0].law) or "plain",
        "nodes": passive.nodes,
        "rate_ratio": passive.rate_ratio,
        "recovers": passive.recovers,
        "sessions": sum(len(motion.recordings) > 1 for motion in data.motions),
    }
    model = assemble(
        "hammerstein", name, data, options, rows, (None, None), passive, True, metadata
    )
    return Fit(model, rows, feature_s=0.0, fit_s=fit_s, metadata=metadata)
