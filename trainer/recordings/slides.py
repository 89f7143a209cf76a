"""Slides: recordings whose tool moves along the surface, with the place of every sample.

A fit takes presses of one place each, and refuses a slide; a scene that slides is compared with it.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording

_FARTHEST_M = 1.0  # of a place, as in a `Recording`
SAME_PLACE_M = 1e-4  # what no printed grid and no stage tells apart
PLACE = ("x_m", "y_m")  # channels of a slide: where on the surface the tool is
LATERAL = (*PLACE, "x_n", "y_n")  # and, if it was measured, the force on the tool along x and y


def place_or_slide(found: Samples) -> tuple[tuple[float, float] | None, dict[str, Samples]]:
    """Return x and y of the place where the tool stays, m, or the channels of a slide.

    found: x and y, m, and, if it was measured, the force along them, N: (n, 2) or (n, 4). A stage
    that trembles stays. The one that it is not is None, or empty.
    """
    path_m = found[:, :2]
    if len(found) and np.ptp(path_m, axis=0).max() <= SAME_PLACE_M:
        x_m, y_m = np.median(path_m, axis=0).tolist()
        return (x_m, y_m), {}
    return None, dict(zip(LATERAL, found.T, strict=False))


def is_slide(recording: Recording) -> bool:
    """Return whether each sample has a place of its own."""
    return all(name in recording.channels for name in PLACE)


def presses_of(recordings: Sequence[Recording]) -> list[Recording]:
    """Return the recordings that do not slide."""
    return [recording for recording in recordings if not is_slide(recording)]


def slide_path(recording: Recording) -> Samples:
    """Return x, y and depth of each sample, (n, 3), m."""
    return np.column_stack([*(recording.channels[name] for name in PLACE), recording.position_m])


def lateral_of(recording: Recording) -> Samples | None:
    """Return the measured force on the tool along x and y, (n, 2), N; None without one."""
    if not all(name in recording.channels for name in LATERAL):
        return None
    return np.column_stack([recording.channels[name] for name in LATERAL[2:]])


def require_path(recording: Recording) -> None:
    """Raise DataError if a slide's places or forces are no numbers, or are far off, as in mm."""
    for name in LATERAL:
        samples = recording.channels.get(name, np.zeros(1))
        if not np.isfinite(samples).all():
            raise DataError(f"{recording.name}: {name} is not finite: cut or repair it")
        if name in PLACE and np.abs(samples).max() > _FARTHEST_M:
            raise DataError(
                f"{recording.name}: {name} goes to {np.abs(samples).max():.4g} m: are these mm? "
                "state the unit of the place, from -1 to 1 m"
            )


def way_words(channels: Mapping[str, Samples]) -> str:
    """Write how far the tool went along x and y, in mm; empty for a press."""
    if not all(name in channels for name in PLACE):
        return ""
    spans = (
        f"{name[0]} {1e3 * channels[name].min():.4g} to {1e3 * channels[name].max():.4g} mm"
        for name in PLACE
    )
    return ", ".join(spans)


def require_presses(recordings: Sequence[Recording]) -> None:
    """Raise DataError for a slide, which no model is fitted to, and none is predicted along."""
    for recording in filter(is_slide, recordings):
        raise DataError(
            f"{recording.name}: slides ({way_words(recording.channels)}), and a model is of "
            "presses of one place each: cut it into one file a place, or leave it out and "
            "compare with it by springpot validate"
        )
