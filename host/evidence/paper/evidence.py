"""All of `springpot reproduce`: objects fitted and validated; figures, tables, claims written."""

import json
import shutil
from collections.abc import Iterable, Sequence
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

from springpot import Scene, read_recordings
from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import UsageError
from springpot.host.api.files import write_scene
from springpot.host.console.output import say
from springpot.host.evidence.paper.claims import PAPER_DEPTHS_MM, PAPER_RATES_HZ, check_claims
from springpot.host.evidence.paper.figures import error_figures, typical_recording
from springpot.host.evidence.paper.order_claims import check_orders
from springpot.host.evidence.paper.page import write_paper_page
from springpot.host.evidence.paper.reproduce import (
    PAPER_KINDS,
    ObjectRecordings,
    ObjectResult,
    Work,
    begin_object,
    by_softness,
    fit_object,
    in_a_line,
    model_metadata,
    shown_object,
    validators,
)
from springpot.host.evidence.paper.row_shares import row_shares, rows_figure
from springpot.host.evidence.paper.sampling import resampled
from springpot.host.evidence.paper.signals import signal_figures
from springpot.host.evidence.paper.unshown_claims import check_unshown
from springpot.host.native.machine import machine_metadata
from springpot.host.simulation.objects import OBJECTS, parse_url

EVIDENCE = "reproduce.json"
_MARK = ".springpot-reproduce"
_PAPER_PAIRS = {
    "ecoflex-00-10": [0.3, 0.35],
    "ecoflex-00-30": [0.15, 0.2],
    "ecoflex-00-50": [0.1, 0.15],
    "dragon-skin-fx": [0.1, 0.15],
    "dragon-skin-10": [0.1, 0.15],
}
STUDY = "study.toml"


def object_names(objects: str | None) -> list[str]:
    """Return names from the command line. Raises UsageError naming an unknown one."""
    names = list(OBJECTS) if objects is None else [name.strip() for name in objects.split(",")]
    for name in names:
        parse_url(f"sim://{name}")
    return list(dict.fromkeys(names))


def recorded(training: Path, validation: Path) -> ObjectRecordings:
    """Return recordings of one real object, named after the training folder."""
    return ObjectRecordings(
        training.stem, tuple(read_recordings(training)), tuple(read_recordings(validation))
    )


def run_reproduce(
    out: Path, data: Iterable[ObjectRecordings], origin: str, work: Work
) -> dict[str, Any]:
    """Do everything into `out`, replacing an earlier result there; returns `reproduce.json`.

    Raises UsageError where `out` holds anything else.
    """
    if out.is_file() or (out.exists() and any(out.iterdir()) and not (out / _MARK).exists()):
        raise UsageError(f"{out}: not empty and no earlier result: give --out a new folder")
    out.mkdir(parents=True, exist_ok=True)
    (out / _MARK).touch()
    shutil.rmtree(out / "models", ignore_errors=True)
    results = _results(data, out / "models", work)
    shown = shown_object(results)
    sampled = resampled(shown.models["rf-fd"], shown.data.validation[typical_recording(shown)])
    say(f"{shown.data.name}: fitted again on more and fewer rows ...")
    shares = row_shares(shown, work)  # with nothing beside it: its times are compared
    say("figures ...")
    figures = error_figures(results, out, origin) + signal_figures(results, sampled, out, origin)
    figures += rows_figure(shares, out, origin)
    claims = check_claims(results, sampled) + check_orders(results)
    claims += check_unshown(results, shares)
    result = {
        "data": origin,
        "tables": tables(results),
        "figures": sorted(figures),
        "models": {
            item.data.name: {kind: model_metadata(model) for kind, model in item.models.items()}
            for item in results
        },
        "rows": shares.as_dict(),
        "past_positions": {
            item.data.name: {kind: vars(found) for kind, found in item.handled.items()}
            for item in results
        },
        "claims": [claim.as_dict() for claim in claims],
        "machine": machine_metadata(),
    }
    write_study_files(out / "study", out / "models", [item.data.name for item in results])
    text = json.dumps(result, indent=2, allow_nan=False) + "\n"
    write_file(out / EVIDENCE, text.encode())
    write_paper_page(out, result)
    return result


def _results(data: Iterable[ObjectRecordings], folder: Path, work: Work) -> list[ObjectResult]:
    """Return all results. Objects are fitted with nothing beside: figure 10 is of those times."""
    fitted = []
    for item in data:
        fitted.append((item, fit_object(item, work)))
        say(f"{item.name}: fitted")
    with validators() as pool:
        begun = [begin_object(item, fits, folder / item.name, work, pool) for item, fits in fitted]
        results = [finish() for finish in begun]
    for result in results:
        say(in_a_line(result))
    return results


def tables(results: Sequence[ObjectResult]) -> dict[str, Any]:
    """Return tables 1 to 3, the paper's numbers beside those found here."""
    return {
        "table1": {
            r.data.name: {
                "paper_mm": PAPER_DEPTHS_MM.get(r.data.name),
                "here_mm": 1e3 * r.data.depth_m,
            }
            for r in by_softness(results)
        },
        "table2": {
            r.data.name: {
                "paper": _PAPER_PAIRS.get(r.data.name),
                "here_on_validation": r.models["rbf-fd"].fit.metadata["pairs"]["paper"],
                "here_cross_validated": r.models["rbf-fd"].fit.metadata["pairs"]["cv"],
            }
            for r in by_softness(results)
        },
        "table3": {
            r.data.name: {
                kind: {
                    "paper_mean_hz": PAPER_RATES_HZ.get(kind),
                    "here_hz": 1e9 / model.validation.ticks.hot_median,
                    "here_paced_cold_hz": 1e9 / model.validation.ticks.p50,
                }
                for kind, model in r.models.items()
            }
            for r in by_softness(results)
        },
    }


def write_study_files(out: Path, models: Path, names: Iterable[str]) -> list[Path]:
    """Write a scene for each of the paper's models, and the study where all five objects are there.

    models: where `<object>/<kind>.spm` lie. Returns what was written.
    """
    out.mkdir(exist_ok=True)
    written = []
    for name in names:
        for kind in PAPER_KINDS:
            if not (models / name / f"{kind}.spm").exists():
                continue
            model = f"{name}-{kind}.spm"
            shutil.copyfile(models / name / f"{kind}.spm", out / model)
            file = out / f"{name}-{kind}.toml"
            write_scene(file, Scene(schema=1, name=f"{name} {kind}", model=model))
            written.append(file)
    if set(OBJECTS) <= {*names}:
        with as_file(files("springpot.host") / "scenes" / "paper-study.toml") as shipped:
            shutil.copyfile(shipped, out / STUDY)
        written.append(out / STUDY)
    return written
