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
    return {
        "noise_floor_n": floor.rms_n,
        "noise_floor_from": floor.source,
        "noise_floor": floor.words,
        "error_per_floor": per_floor,
        "error_per_jnd": found.error_per_jnd,
    }


def floor_words(ratios: dict[str, Any]) -> str:
    """The floor in a person's words. ratios: of `error_ratios`."""
    floor_n, words = ratios["noise_floor_n"], ratios["noise_floor"]
    if floor_n is None:
        return f"not known: {words}"
    if not floor_n:
        return f"0 N, {words}: no ratio"
    return f"{ratios['error_per_floor']:.3g} (floor {floor_n:.3g} N, {words})"


def ratio_rows(ratios: dict[str, Any]) -> dict[str, str]:
    """Two rows under an error."""
    return {
        "error / noise floor": floor_words(ratios),
        "error / JND": f"{ratios['error_per_jnd']:.3g}, rms ({JND_WORDS})",
    }
