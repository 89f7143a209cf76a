"""`make prove`: Eva over the emitted C of every kind, coupling and number type.

    python tests/proof/prove.py [--defects] [--known prove.json] [--out prove.json]
    python tests/proof/prove.py --folder DIR

Exit status 1 where an alarm is left, or a planted defect raises none; 2 without Frama-C, and where
a folder cannot be analysed.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # where pytest looks, too

from proof.eva.analysis import Analysis, EvaFailedError, Known, frama_c
from proof.eva.defects import DEFECTS, Defect, analyse_defect
from proof.eva.ports import PORT_DRIVERS, Port, analyse_port
from proof.eva.scene_analysis import analyse_scene
from proof.eva.scenes import ProvedScene, emit_scene, proved_scenes

_COPY = Path(__file__).parents[2] / "build" / "prove" / "folder"
ASSUMPTIONS = (
    "IEEE 754 arithmetic, round to nearest, no contraction, no extended precision: flags.mk",
    "a state is changed by the functions of its scene alone, and begins with sp_init or sp_reset",
    "pointers are those of objects of the stated sizes; calls for one state do not overlap",
    "the portable C: vector units (AVX2, AVX-512) do not run here: tests compare bits",
    "an index beyond an array of the state that stays within the state is no alarm of the analyser",
    "fabs and sqrt are those of the C standard",
    "models as small as these tests make them: other tables are other C, and are analysed alone "
    "with `python tests/proof/prove.py --folder DIR`",
)


def main() -> int:
    """Run it; returns the exit status."""
    options = _options()
    if frama_c() is None:
        print("prove: Frama-C is not installed: apt-get install frama-c-base", file=sys.stderr)
        return 2
    if options.folder:
        return _report_folder(options.folder)
    began = time.monotonic()
    known = _known(options.known)
    wanted = list(proved_scenes())
    with tempfile.TemporaryDirectory(prefix="prove-") as where, ThreadPoolExecutor(2) as pool:
        folder = Path(where)
        for one in wanted:  # fits each model once, so not in threads
            emit_scene(one, folder)
        rows = _in_pairs(pool, _row, [*wanted, *PORT_DRIVERS], folder, known)
        planted = [one for one in DEFECTS if options.defects]
        defects = _in_pairs(pool, _defect_row, planted, folder, known)
    seconds = time.monotonic() - began
    left = sum(row["alarms"] for row in rows)
    missed = [row["defect"] for row in defects if not row["alarms"]]
    print(f"{len(rows)} programs, {left} alarms; {seconds:.0f} s in all")
    print(f"{len(defects)} defects planted, not seen: {', '.join(missed) or 'none'}")
    if options.out:
        _write(options.out, rows, defects, seconds)
    return 1 if left or missed else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--defects", action="store_true", help="plant each defect too")
    parser.add_argument("--known", type=Path, help="take from it what was answered of the same C")
    parser.add_argument("--folder", type=Path, help="one emitted folder instead")
    parser.add_argument("--out", type=Path, help="write the figures as JSON")
    return parser.parse_args()


def _report_folder(folder: Path) -> int:
    """Analyse a copy, which keeps Eva's log: the folder stays as it was emitted."""
    if not (folder / "sp.c").exists():
        told = "give a folder that `springpot emit` wrote, with the prefix sp"
        print(f"prove: {folder}: no sp.c: {told}", file=sys.stderr)
        return 2
    shutil.rmtree(_COPY, ignore_errors=True)
    shutil.copytree(folder, _COPY)
    try:
        found = analyse_scene(_COPY, timeout_s=3600.0)
    except EvaFailedError as error:
        print(f"prove: {folder}: not analysed: {error}", file=sys.stderr)
        return 2
    for alarm in found.alarms:
        print(alarm)
    print(f"{folder}: {len(found.alarms)} alarms, {found.seconds:.0f} s")
    return 1 if found.alarms else 0


def _known(file: Path | None) -> Known:
    """Answers of an earlier run, by question."""
    if file is None:
        return {}
    stored = json.loads(file.read_text())
    return {
        row["question"]: Analysis(
            (row["caught_by"],) if row["alarms"] else (), row["seconds"], row["question"]
        )
        for row in stored["rows"] + stored["defects"]
        if ("defect" in row) == bool(row["alarms"])  # an alarm is looked at anew
    }


def _in_pairs(
    pool: ThreadPoolExecutor,
    row_of: Callable[[Any, Path, Known], tuple[dict[str, Any], Analysis]],
    those: Sequence[Any],
    folder: Path,
    known: Known,
) -> list[dict[str, Any]]:
    """A row of each, and a line about it as soon as it is known."""

    def run(one: Any) -> dict[str, Any]:
        row, found = row_of(one, folder, known)
        row |= {"seconds": round(found.seconds, 1), "question": found.question}
        named = row.get("defect", row["scene"])
        when = "known" if found.question in known else f"{found.seconds:6.1f} s"
        print(f"{named:45} {row['alarms']:3} alarms {when:>8}", flush=True)
        if "defect" not in row:
            for alarm in found.alarms:
                print(f"    {alarm}", flush=True)
        return row

    return list(pool.map(run, those))


def _row(one: ProvedScene | Port, folder: Path, known: Known) -> tuple[dict[str, Any], Analysis]:
    if isinstance(one, Port):
        its, found = ("port", "", ""), analyse_port(one, folder, known=known)
    else:
        its = one.kind, one.coupling, one.number
        found = analyse_scene(folder / one.name, laws=one.laws, known=known)
    named = dict(zip(("kind", "coupling", "number"), its, strict=True))
    return {"scene": one.name, **named, "alarms": len(found.alarms)}, found


def _defect_row(defect: Defect, folder: Path, known: Known) -> tuple[dict[str, Any], Analysis]:
    found = analyse_defect(defect, folder, known)
    row = {
        "defect": defect.what, "scene": defect.scene.name, "alarms": len(found.alarms),
        "caught_by": found.alarms[0] if found.alarms else "nothing",
    }  # fmt: skip
    return row, found


def _write(
    out: Path, rows: Sequence[dict[str, Any]], defects: Sequence[dict[str, Any]], seconds: float
) -> None:
    version = subprocess.run(
        ["frama-c", "-version"], capture_output=True, text=True, check=True
    ).stdout.strip()
    result = {
        "command": "make prove",
        "version": f"Frama-C {version}",
        "seconds": round(seconds),
        "rows": rows,
        "defects": defects,
        "assumptions": ASSUMPTIONS,
    }
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(main())
