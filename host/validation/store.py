"""A validation for people, and the last one of an emitted folder beside its C, for the report."""

import json
from pathlib import Path

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.codegen.files import atomic_write, write_file
from springpot.codegen.native.compiler import machine_metadata
from springpot.codegen.types import JsonObject
from springpot.host.metrics import (
    error_ratio_keys,
    format_start_errors,
    ratio_rows,
    slope_keys,
    slope_sentence,
)
from springpot.host.session.outcome import note_sentence
from springpot.host.validation.compared import site_sentence
from springpot.host.validation.seen import accepted_signs_sentence, training_overlap_sentence
from springpot.host.validation.validation import Validation
from springpot.trainer.recordings.recording import Recording

_FOLDER = "validation"
_METADATA = "result.json"
_SERIES = "series.npz"
_SUMMARY = (
    "compared", "training data", "signs", "edited C", "RMSE", "  by start", "below the JND",
    "slope error", "by place", "C against reference", "ticks with notes", "tick, paced, cold",
)  # fmt: skip
_ARRAYS = ("position_m", "measured_n", "predicted_n")  # of a recording
Validated = tuple[Recording, Samples]  # and the forces of the C along it, (n,), N


def store_validation(folder: Path, validation: Validation) -> None:
    """Write folder/validation, replacing an earlier one."""
    target = folder / _FOLDER
    target.mkdir(exist_ok=True)
    metadata = {
        "result": validation.as_dict(),
        "rows": validation_rows(validation),
        "machine": machine_metadata(),
        "recordings": [
            {"name": rec.name, "dt_s": rec.dt_s, "source": rec.source, "hash": rec.content_hash}
            for rec in validation.recordings
        ],
    }
    arrays: dict[str, Samples] = {}
    pairs = zip(validation.recordings, validation.predicted_n, strict=True)
    for i, (recording, force_n) in enumerate(pairs):
        series = (recording.position_m, recording.force_n, force_n)
        arrays |= {f"{name}_{i}": values for name, values in zip(_ARRAYS, series, strict=True)}
    with atomic_write(target / _SERIES) as aside, aside.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    write_file(target / _METADATA, (json.dumps(metadata, indent=2) + "\n").encode())


def read_validation(folder: Path) -> tuple[JsonObject, list[Validated]]:
    """Read folder/validation: its result, rows, machine and recordings; and these themselves.

    Raises DataError where there is none.
    """
    target = folder / _FOLDER
    try:
        metadata = json.loads((target / _METADATA).read_text(encoding="utf-8"))
        metadata["rows"], metadata["result"]["verdict"]  # which an older validation lacks
        with np.load(target / _SERIES, allow_pickle=False) as stored:
            pairs = []
            for i, rec in enumerate(metadata["recordings"]):
                position_m, measured_n, predicted_n = (stored[f"{name}_{i}"] for name in _ARRAYS)
                recording = Recording(rec["name"], position_m, measured_n, rec["dt_s"])
                pairs.append((recording, predicted_n))
            return metadata, pairs
    except (OSError, ValueError, KeyError):
        raise DataError(
            f"{folder}: no validation to report: run `springpot validate {folder} --recording ...`"
        ) from None


def _parts(validation: Validation) -> str:
    """Return the model's own error, and what coupling, guard and limits make of it.

    Neither is a part of the scene's error: the two may make up for each other.
    """
    alone_n, added_n = validation.model_rmse_n, validation.rendering_n
    if alone_n is None or added_n is None:
        return "not known"
    words = f"{alone_n:.4g} N; coupling, guard and limits change its force by {added_n:.4g} N (RMS)"
    if validation.felt:
        words += ", logs of sessions left out"
    coupling = validation.manifest.get("coupling", {})
    if added_n > alone_n and coupling.get("mode", "off") != "off":
        felt = 1e-3 * coupling["felt_stiffness_npm"]
        words += f": the hand feels {felt:.3g} N/mm through the coupling, see `springpot emit`"
    return words


def summary_rows(validation: Validation) -> dict[str, str]:
    """Return what a command prints: the verdict, and what a person looks at first."""
    rows = validation_rows(validation)
    if not any(n for note, n in validation.notes.items() if note not in ("resync", "ramped")):
        rows.pop("ticks with notes", None)  # those with which every recording begins
    judged = len(validation.felt) < len(validation.predicted_n)
    verdict = {"verdict": validation.verdict} if judged else {}
    return verdict | {name: rows[name] for name in _SUMMARY if name in rows}


def validation_rows(validation: Validation) -> dict[str, str]:
    """Return all rows of a validation, for its page."""
    error, ticks, felt = validation.accuracy, validation.ticks, validation.felt
    seen = training_overlap_sentence(validation.seen, len(validation.predicted_n))
    interval = error.interval_n
    spread = f", 95 % in {interval[0]:.4g} .. {interval[1]:.4g}" if interval else ""
    again = "the calls of the session made again; the force sent is compared with that of the C, "
    rows = {
        "compared": f"{', '.join(felt)}: {again}not with a measured object" if felt else "",
        "training data": seen,
        "signs": accepted_signs_sentence(validation.manifest),
        "edited C": ", ".join(validation.edited),
        "samples": str(error.samples)
        + (f", {error.ramped} of them in the start-up ramp: not counted" if error.ramped else ""),
    }
    differ = f"{validation.mismatches} ticks differ"
    presses = "{:.4g} N; later ones {:.4g} N"
    presses = presses.format(*validation.presses_n) if validation.presses_n else ""
    if len(felt) < len(validation.predicted_n):
        rows |= {
            "RMSE": f"{error.rmse_n:.4g} N, {error.rmse_percent_of_peak:.3g} % of peak; at most "
            f"{error.max_abs_error_n:.4g} N",
            "RMSE, the model alone": _parts(validation),
            "  by start": format_start_errors(validation.rmse_by_start_n),
            "RMSE, first presses": presses,
            **ratio_rows(error_ratio_keys(error, validation.floor)),
            "slope error": slope_sentence(slope_keys(validation.slopes)),
            "by place": site_sentence(validation.places),
            "RMSE, mean of recordings": f"{error.mean_recording_rmse_n:.4g} N{spread}",
            "mean error": f"{error.mean_error_n:+.4g} N (the C less the measured force)",
            "99 % of errors": f"below {error.p99_abs_error_n:.4g} N",
        }
    else:
        felt_too = ", and so does what was felt"
        means = felt_too if validation.mismatches else ": what was felt is what the model says"
        differ = f"{validation.mismatches} of {error.samples} ticks differ{means}"
        if silent := validation.notes.get("latched", 0):
            differ += (
                f"; {100.0 * silent / error.samples:.0f} % of the ticks, latched, had no force"
            )
    note_words = note_sentence(validation.notes, validation.clamped_low, validation.min_n)
    rows |= {
        "C against reference": differ,
        "ticks with notes": note_words,
        "tick, hot": f"{ticks.hot_median / 1e3:.3g} us",
        "tick, paced, cold": f"{ticks.p50 / 1e3:.3g} us, 99 % below {ticks.p99 / 1e3:.3g} us",
    }
    return {name: text for name, text in rows.items() if text}
