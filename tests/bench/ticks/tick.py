"""One tick of every way to render the paper's forest, side by side in one run.

python tests/bench/ticks/tick.py [--json FILE]: a table with ratios to the literal tick. Hot: median
over stretches of a recorded motion, the rows in turn. Paced: at 1 kHz with disturbed caches.
Instructions: callgrind, which has no AVX-512; those rows have none.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))
from support.silicones import paper_presses, validation_signals
from tick_peers import peer_rows
from tick_rows import HERE, Row, Stepper, literal_row, scene_rows

from springpot.codegen.model.features import FirBank
from springpot.codegen.native.compiler import compiler_version, find_compiler, machine_metadata
from springpot.codegen.scene import Coupling, Smoothing
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.rf_fd import compute_depth_scale, fit_forest
from springpot.trainer.models.training_set import build_training_set

OBJECT = "ecoflex-00-30"
STRETCH = 500
ROUNDS = 3
PACED_TICKS = 2000
COLD_BYTES = 8 << 20
AVX2, AVX512 = 1, 2


def rows_of(folder: Path, recordings: Any) -> tuple[list[Row], Any, np.ndarray]:
    """Fit, emit and build everything."""
    options = FitOptions()
    exact = fit_model("rf-fd", OBJECT, recordings, options).model
    rounded = fit_model("rf-fd", OBJECT, recordings, FitOptions(round_features=True)).model
    rbf = fit_model("rbf-fd", OBJECT, recordings, options).model
    hammerstein = fit_model("hammerstein", OBJECT, recordings, options).model
    assert isinstance(exact.features, FirBank)
    data = build_training_set(recordings, options.smooth_s)
    chosen = data.rows(None, options.seed)
    scale = compute_depth_scale(data.trained.max_m)
    values = scale * data.features(exact.features, chosen)
    ensemble = fit_forest(options, values.astype(np.float32), data.force_n(chosen))
    plain = {"coupling": Coupling(mode="off"), "smoothing": Smoothing(0.0)}
    rows = [
        literal_row(ensemble, scale, exact.features, folder / "literal"),
        *scene_rows(exact, {AVX512: "rf-fd-exact", AVX2: "rf-fd-exact-avx2",
                            0: "rf-fd-exact-portable"}, folder / "exact"),
        *scene_rows(rounded, {AVX512: "rf-fd-rounded", AVX2: "rf-fd-rounded-avx2",
                              0: "rf-fd-rounded-portable"}, folder / "rounded"),
        *scene_rows(rbf, {0: "rbf-fd"}, folder / "rbf"),
        *scene_rows(hammerstein, {0: "hammerstein"}, folder / "hammerstein"),
        *scene_rows(rbf, {0: "rbf-fd-uncoupled"}, folder / "rbf-plain", **plain),
        *scene_rows(hammerstein, {0: "hammerstein-uncoupled"}, folder / "passive-plain", **plain),
    ]  # fmt: skip
    return rows, ensemble, values.astype(np.float32)


def timed(rows: list[Row], position_m: np.ndarray) -> tuple[dict[str, float], dict[str, Any]]:
    """Hot median and paced times of each row."""
    velocity_mps = np.gradient(position_m, 1e-3)
    steppers = [Stepper(row, position_m, velocity_mps) for row in rows]
    hot: dict[str, list[float]] = {row.what: [] for row in rows}
    for _ in range(ROUNDS):
        for begin in range(0, len(position_m) - STRETCH, STRETCH):
            for stepper in steppers:
                hot[stepper.row.what].append(stepper.hot_ns(begin, STRETCH))
    cold = np.zeros(COLD_BYTES, dtype=np.uint8)
    paced = {}
    for stepper in steppers:
        tick_ns = stepper.paced_ns(PACED_TICKS, 1e-3, cold)
        paced[stepper.row.what] = np.percentile(tick_ns, [50, 99])
    return {what: float(np.median(times)) for what, times in hot.items()}, paced


def instructions(row: Row, position_m: np.ndarray, folder: Path) -> float | None:
    """Instructions of a tick, by the difference of two runs under callgrind."""
    if shutil.which("valgrind") is None or row.vectors == AVX512:
        return None
    counter = folder / "count"
    if not counter.exists():
        source = HERE / "tick_count.c"
        subprocess.run(
            [*find_compiler(), "-O2", "-D_GNU_SOURCE", source, "-o", counter, "-ldl"], check=True
        )
    positions = folder / "positions.bin"
    position_m.astype(np.float32).tofile(positions)
    counts = []
    for ticks in (500, 1500):
        out = folder / "callgrind.out"
        subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", counter, row.library,
             row.step, row.init or "-", str(row.state_bytes), positions, str(ticks)],
            check=True, capture_output=True,
        )  # fmt: skip
        summary = [line for line in out.read_text().splitlines() if line.startswith("summary:")]
        counts.append(int(summary[0].split()[1]))
    return (counts[1] - counts[0]) / 1000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    signals = validation_signals(OBJECT, 4)
    position_m = np.concatenate([item.position_m for item in signals[2:]])
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        rows, ensemble, features = rows_of(folder, paper_presses(OBJECT))
        hot, paced = timed(rows, position_m)
        table = [
            {
                "what": row.what, "hot_ns": hot[row.what], "paced_p50_ns": paced[row.what][0],
                "paced_p99_ns": paced[row.what][1],
                "instructions": instructions(row, position_m, folder), "bytes": row.bytes,
                "write_s": row.write_s, "compile_s": row.compile_s,
            }
            for row in rows
        ]  # fmt: skip
        table += peer_rows(ensemble, features, folder)
    result = {
        "machine": machine_metadata()["processor"],
        "compiler": compiler_version(find_compiler()),
        "object": OBJECT,
        "rows": table,
    }
    say(table)
    if asked.json:
        asked.json.write_text(json.dumps(result, indent=2) + "\n")


def say(table: list[dict[str, Any]]) -> None:
    """Print a table with ratios to the literal tick."""
    literal = table[0]["hot_ns"]
    head = (
        "what",
        "hot ns",
        "literal/",
        "p50 cold",
        "p99 cold",
        "instr.",
        "bytes",
        "write s",
        "cc",
    )
    print("{:24}{:>9}{:>9}{:>9}{:>9}{:>8}{:>10}{:>8}{:>7}".format(*head))
    keys = ("paced_p50_ns", "paced_p99_ns", "instructions", "bytes", "write_s", "compile_s")
    for row in table:
        cells = [("-" if row[key] is None else f"{row[key]:.3g}" if key.endswith("_s")
                  else f"{row[key]:.0f}") for key in keys]  # fmt: skip
        ratio = literal / row["hot_ns"]
        print("{:24}{:9.0f}{:9.2f}{:>9}{:>9}{:>8}{:>10}{:>8}{:>7}".format(
            row["what"], row["hot_ns"], ratio, *cells))  # fmt: skip


if __name__ == "__main__":
    main()
