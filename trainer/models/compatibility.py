"""Whether a recording and a model mean the same by a position and a tick."""

from springpot.codegen.errors import DataError
from springpot.codegen.model.model import Model
from springpot.trainer.recordings.recording import Recording, Zero


def zero_of(model: Model) -> Zero:
    """Zero that an importer gave to the model's recordings.

    A preloaded object has no surface, whether or not it was moved. Models of old do not say.
    """
    zero: Zero = model.provenance.get("zero", "min" if model.contact == "always" else "none")
    return zero


def require_compatible(recording: Recording, model: Model, tick_s: float | None = None) -> None:
    """Raise DataError for another sampling rate, or another meaning of position 0.

    tick_s: of the scene, which may have a rate of its own; without one, the model's. A model that
    is exact at any rate takes slower recordings too, see `at_ticks`.
    """
    dt_s, whose = (model.dt_s, "model") if tick_s is None else (tick_s, "scene")
    ticks_between = recording.dt_s / dt_s
    slower = tick_s is not None and model.exact_at_any_rate and ticks_between > 1.0
    if not slower and abs(ticks_between - 1.0) > 1e-3:
        raise DataError(
            f"{recording.name} is sampled at {recording.rate_hz:g} Hz, the {whose} at "
            f"{1 / dt_s:g} Hz: import it from its source with --resample-hz {1 / dt_s:g}"
        )
    moved = zero_of(model) != "none"
    if (recording.zero != "none") != moved:
        raise DataError(
            f"{recording.name} was imported with --zero {recording.zero}, the model's recordings "
            f"{'with' if moved else 'without'} --zero first or min: import all the same way"
        )
