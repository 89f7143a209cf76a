"""A study as a BIDS data set of behaviour (brain imaging data structure 1.9, modality beh)."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from springpot import UsageError
from springpot.basics import write_file
from springpot.host.wings.study.report.analysis import Analysis
from springpot.host.wings.study.report.tables import csv_text, trial_rows
from springpot.host.wings.study.responses import Response

_COLUMNS: dict[str, dict[str, Any]] = {
    "trial": {"Description": "Number of the trial in its session, from 1"},
    "attempt": {"Description": "From 1; later ones come after a trial that was interrupted"},
    "condition": {"Description": "What was compared: levels of the factors, or both stimuli"},
    "left": {"Description": "First stimulus of the pair"},
    "right": {"Description": "Second stimulus of the pair"},
    "shown": {"Description": "Stimuli in the places, left to right; of ABX: A, B, X"},
    "swapped": {"Description": "Whether the second stimulus of the pair was in the first place"},
    "level": {"Description": "Level of the second stimulus, by default its factor of stiffness"},
    "answer": {"Description": "What the person answered"},
    "correct": {"Description": "Whether the answer is right, of methods that know"},
    "response_time": {"Description": "From showing the trial to the answer", "Units": "s"},
    "presses": {"Description": "Presses of all stimuli in the trial"},
    "deepest": {"Description": "Greatest penetration", "Units": "m"},
    "fastest": {"Description": "Greatest speed in contact", "Units": "m/s"},
    "warnings": {"Description": "Warnings given: too deep, or too fast"},
    "excluded": {"Description": "Whether a rule set before the data leaves this person out"},
    "counts": {"Description": "Whether the results are made of it: no practice, nobody left out"},
}
_NAMES = {"seconds": "response_time", "deepest_m": "deepest", "fastest_mps": "fastest"}
_LEFT_OUT = {"participant", "session", "log"}  # they are in the file's name, or of this machine


def write_bids(
    analysis: Analysis,
    responses: Sequence[Response],
    participants: str,
    version: str,
    folder: Path,
) -> list[str]:
    """Write the data set; practice is left out. participants: text of the study's participants.tsv.

    Return the file names. Raises UsageError where something is there already."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UsageError(f"{folder}: exists: give a new folder for --bids")
    study = analysis.study
    task = re.sub("[^A-Za-z0-9]", "", study.name.title()) or "study"
    description = {
        "Name": study.name,
        "BIDSVersion": "1.9.0",
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "springpot", "Version": version}],
    }
    factors = {name for pair in study.pair for name in pair.factors}
    sidecar: dict[str, Any] = {
        "TaskName": task,
        "TaskDescription": f"{study.name}: method {study.method}",
        **_COLUMNS,
        **{name: {"Description": "Factor of the analysis of variance"} for name in sorted(factors)},
    }
    files = {
        "dataset_description.json": _json(description),
        "participants.tsv": participants,
        "README": f"{study.name}. Trials of a perceptual study, written by `springpot study "
        "report --bids`.\n",
    }
    sessions = dict.fromkeys((r.participant, r.session) for r in responses if r.session > 0)
    for participant, session in sessions:
        own = [r for r in responses if (r.participant, r.session) == (participant, session)]
        rows = [
            {_NAMES.get(name, name): value for name, value in row.items() if name not in _LEFT_OUT}
            for row in trial_rows(analysis, own)
        ]
        stem = f"sub-{participant}_ses-{session}_task-{task}_beh"
        place = f"sub-{participant}/ses-{session}/beh/{stem}"
        files[f"{place}.tsv"] = csv_text(rows, "\t", "n/a")
        files[f"{place}.json"] = _json(sidecar)
    for name, text in files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        write_file(file, text.encode())
    return list(files)


def _json(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"
