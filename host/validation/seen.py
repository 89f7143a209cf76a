"""Whether recordings are a model's own training data: their error is then not that of new ones.

A model holds hashes of the samples that it was fitted on. Another name or folder does not hide a
recording; of one that was cut, resampled or converted since, the hash is another, and cannot say.
"""

from collections.abc import Collection, Mapping, Sequence

from springpot.codegen.model.model import Model
from springpot.codegen.types import JsonMapping
from springpot.trainer.recordings.recording import Recording


def count_training_recordings(model: Model, recordings: Sequence[Recording]) -> int | None:
    """Count the recordings that the model was trained on; None if the model does not name any."""
    hashes = model.provenance.get("recordings")
    if not isinstance(hashes, Mapping) or not hashes:
        return None
    return known_among(set(hashes.values()), recordings, model.provenance.get("smooth_s", 0.0))


def known_among(
    hashes: Collection[str], recordings: Sequence[Recording], smooth_s: float = 0.0
) -> int:
    """Count recordings that have one of these hashes, as they are or as a fit prepares them."""
    from springpot.trainer.recordings.quality.spikes import replace_spikes
    from springpot.trainer.recordings.signals import smooth

    return sum(
        recording.content_hash in hashes
        or smooth(replace_spikes(recording)[0], smooth_s).content_hash in hashes
        for recording in recordings
    )


def accepted_signs_sentence(manifest: JsonMapping) -> str:
    """Training recordings with signs that a person accepted on import; "" where there are none."""
    accepted = manifest.get("provenance", {}).get("accepted_signs", [])
    return f"accepted, against the data, of {', '.join(accepted)}" if accepted else ""


def training_overlap_sentence(seen: int | None, recordings: int) -> str:
    """Return the line before the figures; nothing where all recordings are new."""
    if seen is None:
        return "the model does not say which recordings it was trained on"
    if not seen:
        return ""
    return (
        f"{seen} of {recordings} of these recordings are training data: the error is not that of "
        "new ones"
    )
