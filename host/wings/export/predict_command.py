"""`springpot predict`: the force of a model along recordings."""

from __future__ import annotations

from pathlib import Path

import click

from springpot import UsageError
from springpot.console import json_option, print_result, say
from springpot.validation import rms


@click.command("predict")
@click.argument("model", type=click.Path(path_type=Path))
@click.argument("recordings", nargs=-1, required=True, type=click.Path(), metavar="REC...")
@click.option(
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    help="Folder to write a CSV file of each into.",
)
@json_option
def predict(model: Path, recordings: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Write the force of MODEL along recordings (files or folders), beside the measured one.

    The force is the model's own, without coupling and guard, and never pulls at a surface.
    """
    import numpy as np

    from springpot import read_model, read_recordings
    from springpot.host.wings.export.exporting import write_prediction
    from springpot.modelling import (
        extrapolation,
        limited_n,
        require_compatible,
        require_presses,
        sign_doubts,
        unplaced,
    )

    fitted = read_model(model)
    found = read_recordings(*recordings)
    require_presses(found)
    for doubt in sign_doubts(found):
        say(f"warning: {doubt}")
    names = [recording.name for recording in found]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError(f"two recordings are named {twice[0]}: give one of them at a time")
    forces = []
    for recording in found:
        require_compatible(recording, fitted)
        forces.append(limited_n(fitted, recording))
        for doubt in filter(None, (unplaced(fitted, recording), extrapolation(fitted, recording))):
            say(f"warning: {doubt}")
    files = [
        str(write_prediction(out, recording, force_n))
        for recording, force_n in zip(found, forces, strict=True)
    ]
    errors_n = [item.force_n - force_n for item, force_n in zip(found, forces, strict=True)]
    rmse_n = rms(np.concatenate(errors_n))
    peak_n = max(float(np.max(np.abs(item.force_n))) for item in found)
    percent = 100.0 * rmse_n / peak_n if peak_n > 0.0 else None
    result = {"out": str(out), "files": files, "rmse_n": rmse_n, "rmse_percent_of_peak": percent}
    rows = dict(zip(names, files, strict=True))
    rows["RMSE"] = f"{rmse_n:.4g} N" + (f", {percent:.3g} % of peak" if percent is not None else "")
    print_result(result, as_json, rows)
