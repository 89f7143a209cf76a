"""Bytes and time of a tick as WebAssembly, beside the same portable C on this machine.

    python tests/bench/wasm.py training validation --out wasm.json

Fits each kind on the recordings of the first folder and replays the longest of the second, in node
and here, twelve times in turn; the lowest time of each counts. results.py makes the table of it.
"""

import argparse
import json
import os
import subprocess
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.model.model import Model
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Number
from springpot.host.native.machine import machine_metadata
from springpot.host.wings.evidence.benchmark.isolated import NODE_TICKS, node_and_portable_ns
from springpot.host.wings.evidence.benchmark.measure import (
    bench_scene,
    target_compiler,
    target_sizes,
)
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import read_recordings

KINDS = ("hammerstein", "hybrid", "boosted", "rf-fd", "rbf-fd", "rbf-pv")
NUMBERS: tuple[Number, ...] = ("float32", "float64")
ROUNDS = 12
TITLE = "## WebAssembly\n"


def measured(models: dict[str, Model], position_m: np.ndarray) -> list[dict[str, Any]]:
    """Rows of the table. A round visits all: a slow minute of the machine hits no single row."""
    cases = list(product(models, NUMBERS))
    times = np.full((len(cases), 2), np.inf)
    for _ in range(ROUNDS):
        for i, (kind, number) in enumerate(cases):
            plan = make_plan(models[kind], bench_scene(number, "wasm32"), accept_unsafe=True)
            position = np.resize(position_m, NODE_TICKS).astype(plan.dtype)
            times[i] = np.minimum(times[i], node_and_portable_ns(plan, position))
    return [
        {
            "model": kind,
            "number": number,
            "bytes": target_sizes(models[kind], number, "wasm32").flash_bytes,
            "node_ns": node_ns,
            "here_ns": here_ns,
        }
        for (kind, number), (node_ns, here_ns) in zip(cases, times.tolist(), strict=True)
    ]


def wasm_section(found: dict[str, Any]) -> list[str]:
    """The lines of docs/explanation/results.md."""
    return [
        TITLE,
        f"`python tests/bench/wasm.py`: models of recordings of the {found['name']}; "
        f"{found['machine']}; {found['clang']}, node {found['node']}; here: {found['compiler']}. "
        f"{NODE_TICKS} ticks at once without a coupling, the same portable C on both sides, every "
        f"force and note the same bits; each time is the lowest of {ROUNDS} rounds, load average "
        f"{found['load']:.1f} before they began.\n",
        "| model | number | module, bytes | tick in node, µs | tick here, µs | node / here |",
        "| --- | --- | --- | --- | --- | --- |",
        *(
            f"| {row['model']} | {row['number']} | {row['bytes']} | {1e-3 * row['node_ns']:.3f} | "
            f"{1e-3 * row['here_ns']:.3f} | {row['node_ns'] / row['here_ns']:.1f} |"
            for row in found["wasm"]
        ),
        "",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("training", type=Path)
    parser.add_argument("validation", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    training = tuple(read_recordings([options.training]))
    longest = max(read_recordings([options.validation]), key=lambda item: len(item.position_m))
    load = os.getloadavg()[0]
    models = {kind: fit_model(kind, "x", training, FitOptions(seed=1)).model for kind in KINDS}
    rows = measured(models, longest.position_m)
    machine = machine_metadata()
    told = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout
    found = {
        "name": "simulated " + training[0].source.removeprefix("sim://").split("?")[0],
        "machine": machine["processor"],
        "compiler": machine["compiler"],
        "clang": target_compiler("wasm32"),
        "node": told.strip().removeprefix("v"),
        "load": load,
        "wasm": rows,
    }
    options.out.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
