"""An error beside what no model can predict, and beside what a hand can tell."""

from typing import Any

from springpot.host.metrics import SCORED_ABOVE_N, WEBER_FRACTION, Accuracy
from springpot.trainer.recordings.quality.noise_floor import NoiseFloor

JND_WORDS = (
    f"a hand can tell {100 * WEBER_FRACTION:g} % of the force from {SCORED_ABOVE_N:g} N on, "
    f"{WEBER_FRACTION * SCORED_ABOVE_N:g} N below"
)


def error_ratios(found: Accuracy, floor: NoiseFloor) -> dict[str, Any]:
    """JSON keys: the floor and what it is from, the RMSE over it, the error over the JND."""
    per_floor = found.rmse_n / floor.rms_n if floor.rms_n else None
    return floor_keys(floor) | {
        "error_per_floor": per_floor,
        "error_per_jnd": found.error_per_jnd,
    }


def floor_keys(floor: NoiseFloor) -> dict[str, Any]:
    """JSON keys of a floor alone."""
    return {
        "noise_floor_n": floor.rms_n,
        "noise_floor_from": floor.source,
        "noise_floor": floor.words,
    }


def floor_words(floor: dict[str, Any]) -> str:
    """A floor in a person's words. floor: of `floor_keys`."""
    floor_n, words = floor["noise_floor_n"], floor["noise_floor"]
    if floor_n is None:
        return f"not known: {words}"
    return f"{floor_n:.3g} N, {words}" if floor_n else f"0 N, {words}: no ratio"


def ratio_rows(ratios: dict[str, Any]) -> dict[str, str]:
    """Two rows under an error."""
    words, ratio = floor_words(ratios), ratios["error_per_floor"]
    return {
        "error / noise floor": words if ratio is None else f"{ratio:.3g} (floor {words})",
        "error / JND": f"{ratios['error_per_jnd']:.3g}, rms ({JND_WORDS})",
    }
