"""`springpot validate`: replay recordings through the C."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.host.console.options import accept_edited_option
from springpot.host.console.output import json_option, print_result, progress_console

if TYPE_CHECKING:
    from springpot.host.validation.validation import Validation


@click.command(name="validate")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--recording",
    "recordings",
    multiple=True,
    required=True,
    type=click.Path(),
    metavar="REC",
    help="Recording or folder; may be repeated.",
)
@click.option(
    "--device", "url", help="A board that renders the scene, such as serial:///dev/ttyACM0."
)
@accept_edited_option
@json_option
def validate_(
    folder: Path, recordings: tuple[str, ...], url: str | None, accept_edited: bool, as_json: bool
) -> None:
    """Replay recordings through the C of an emitted FOLDER."""
    from springpot.host.validation.store import store_validation
    from springpot.host.validation.validation import fail_on_mismatch, validate
    from springpot.trainer.recordings.recording_file import read_recordings

    found = read_recordings(map(Path, recordings))
    with progress_console.status(f"replaying {len(found)} recordings"):
        validation = validate(folder, found, device=url, accept_edited=accept_edited)
    store_validation(folder, validation, found)
    print_result(validation.as_dict(), as_json, validation_rows(validation))
    fail_on_mismatch(folder, validation)


def validation_rows(validation: Validation) -> dict[str, str]:
    """A person's view of a validation."""
    from springpot.host.validation.seen import seen_line

    found, ticks = validation.accuracy, validation.ticks
    told = seen_line(validation.seen, len(validation.predicted_n))
    interval = found.interval_n
    spread = f", 95 % in {interval[0]:.4g} .. {interval[1]:.4g}" if interval else ""
    below = found.ape_below_jnd
    return {
        **({"training data": told} if told else {}),
        **({"edited C": ", ".join(validation.edited)} if validation.edited else {}),
        "samples": str(found.samples)
        + (f", {found.ramped} of them in the start-up ramp: not counted" if found.ramped else ""),
        "RMSE": f"{found.rmse_n:.4g} N, {found.rmse_percent_of_peak:.3g} % of peak",
        "RMSE, mean of recordings": f"{found.mean_recording_rmse_n:.4g} N{spread}",
        "maximum error": f"{found.max_abs_error_n:.4g} N; 99 %: {found.p99_abs_error_n:.4g} N",
        "below the JND above 2 N": "no such sample" if below is None else f"{100 * below:.1f} %",
        "C against reference": f"{validation.mismatches} ticks differ",
        "notes": ", ".join(f"{name} {count}" for name, count in validation.notes.items() if count)
        or "none",
        "tick, hot": f"{ticks.hot_median / 1e3:.3g} us",
        "tick, paced, cold": f"{ticks.p50 / 1e3:.3g} us, 99 % below {ticks.p99 / 1e3:.3g} us",
    }
