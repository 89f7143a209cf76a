"""Bytes and time of a tick as WebAssembly, beside the same portable C on this machine.

    python tests/bench/wasm.py training validation --out wasm.json

Fits each kind on the recordings of the first folder and replays the longest of the second, in node
and here, twelve times in turn; the lowest time of each counts. results.py makes the table of it.
"""

import argparse
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.model.model import Model
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.scene import Number
from springpot.host.benchmark.measure import bench_scene, target_compiler, target_sizes
from springpot.host.benchmark.node_ticks import NODE_TICKS, node_and_portable_ns
from springpot.host.native.machine import machine_metadata
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording_file import read_recordings

KINDS = ("hammerstein", "hybrid", "boosted", "rf-fd", "rbf-fd", "rbf-pv")
NUMBERS: tuple[Number, ...] = ("float32", "float64")
ROUNDS = 12
TITLE = "## WebAssembly\n"


def measured(model: Model, number: Number, position_m: np.ndarray) -> dict[str, Any]:
    """One row of the table."""
    plan = make_plan(model, bench_scene(number, "wasm32"), accept_unsafe=True)
    position = np.resize(position_m, NODE_TICKS).astype(plan.dtype)
    times = [node_and_portable_ns(plan, position) for _ in range(ROUNDS)]
    node_ns, portable_ns = np.min(times, axis=0)
    sizes = target_sizes(model, number, "wasm32")
    return {
        "number": number,
        "bytes": sizes.flash_bytes,
        "node_ns": node_ns,
        "here_ns": portable_ns,
    }


def wasm_section(found: dict[str, Any]) -> list[str]:
    """The lines of docs/results.md."""
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
    rows = []
    for kind in KINDS:
        model = fit_model(kind, "x", training, FitOptions(seed=1)).model
        rows += [
            {"model": kind} | measured(model, number, longest.position_m) for number in NUMBERS
        ]
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
