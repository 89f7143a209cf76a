"""`springpot predict`: the force of a model along recordings."""

from __future__ import annotations

from pathlib import Path

import click

from springpot.codegen.errors import UsageError
from springpot.host.console.options import PATH
from springpot.host.console.output import json_option, print_result, say


@click.command("predict")
@click.argument("model", type=PATH)
@click.argument("recordings", nargs=-1, required=True, type=click.Path(), metavar="REC...")
@click.option("--out", required=True, type=PATH, help="Folder to write a CSV file of each into.")
@json_option
def predict(model: Path, recordings: tuple[str, ...], out: Path, as_json: bool) -> None:
    """Write the force of MODEL along recordings (files or folders), beside the measured one.

    The force is the model's own, without coupling and guard, and never pulls at a surface.
    """
    import numpy as np

    from springpot.codegen.model.model_file import read_model
    from springpot.trainer.models.compatibility import require_compatible
    from springpot.trainer.models.limited import extrapolation, limited_n
    from springpot.trainer.recordings.formats.exporting import write_prediction
    from springpot.trainer.recordings.quality.signs import sign_doubts
    from springpot.trainer.recordings.recording_file import read_recordings

    fitted = read_model(model)
    found = read_recordings(map(Path, recordings))
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
        if doubt := extrapolation(fitted, recording):
            say(f"warning: {doubt}")
    files = [
        str(write_prediction(out, recording, force_n))
        for recording, force_n in zip(found, forces, strict=True)
    ]
    errors_n = [item.force_n - force_n for item, force_n in zip(found, forces, strict=True)]
    rmse_n = float(np.sqrt(np.mean(np.concatenate(errors_n) ** 2)))
    peak_n = max(float(np.max(np.abs(item.force_n))) for item in found)
    percent = 100.0 * rmse_n / peak_n if peak_n > 0.0 else None
    result = {"out": str(out), "files": files, "rmse_n": rmse_n, "rmse_percent_of_peak": percent}
    rows = dict(zip(names, files, strict=True))
    rows["RMSE"] = f"{rmse_n:.4g} N" + (f", {percent:.3g} % of peak" if percent is not None else "")
    print_result(result, as_json, rows)
