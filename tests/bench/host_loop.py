"""`make bench-host`: sessions over simulated devices while another thread formats text.

    python tests/bench/host_loop.py [--runs 3] [--share 1.0] [--out build/bench-host.json]

Each line is one session: the C loop over the serial device at 1 kHz for 60 s and at 4 kHz for 20 s,
over slcan and over python-can's udp_multicast at 1 kHz for 20 s. A kind passes where at least two
of three runs meet its limits. share: of each duration, for a quick look.
"""

import argparse
import json
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from support.peer import peer
from support.small import DEPTH_M, model_file, scene, small_model

from springpot.codegen.model.model import Model
from springpot.host.emission.emission import emit
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.output import say
from springpot.host.session.session import Session
from springpot.host.validation.compared import repeat_session
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import read_recording


@dataclass(frozen=True)
class Kind:
    """One row: device, rate, duration, how many runs, and its limits."""

    peer: str
    rate_hz: int
    seconds: float
    runs: int
    ticks_within: float = 0.001
    fresh: float = 0.0
    gates: bool = True


KINDS = (
    Kind("serial_device", 1000, 60, 3),
    Kind("serial_device", 4000, 20, 3, ticks_within=0.01),
    Kind("slcan_odrive", 1000, 20, 3, fresh=0.99),
    Kind("udp_odrive", 1000, 20, 1, gates=False),
)


def model_at(rate_hz: int) -> Model:
    """A small forest for recordings of that rate."""
    if rate_hz == 1000:
        return small_model()
    dt_s = 1 / rate_hz
    recordings = []
    for frequency_hz in (1.0, 3.0):
        time_s = np.arange(round(rate_hz / frequency_hz)) * dt_s
        depth_m = DEPTH_M / 2 * (1 - np.cos(2 * np.pi * frequency_hz * time_s))
        force_n = 250 * depth_m + 4e4 * depth_m**2 + 2 * np.gradient(depth_m, dt_s)
        recordings.append(Recording(f"{frequency_hz}", depth_m, np.maximum(force_n, 0), dt_s))
    return fit_model("rf-fd", "small", recordings, FitOptions(seed=1, trees=5, leaf=20)).model


def run(kind: Kind, folder: Path, log: Path) -> dict[str, Any]:
    """One session with a busy thread beside it: its result, and what validation says of its log."""
    busy = True

    def work() -> None:
        while busy:
            " ".join(f"{k:.9f}" for k in range(500))

    options = ("--rate-hz", kind.rate_hz) if kind.peer != "serial_device" else ()
    with peer(kind.peer, *options) as device:
        worker = threading.Thread(target=work, daemon=True)
        worker.start()
        session = Session(folder, device.url, log, seconds=kind.seconds, report=say)
        with session:
            session.start()
            while not session.over:
                time.sleep(0.1)
        busy = False
        worker.join()
    result = session.result()
    result["fresh"] = 1 - result["stale_samples"] / result["ticks"]
    repeated = repeat_session(Replay(SceneLibrary(folder)), read_recording(log), result["hash"])
    assert repeated is not None
    result["mismatches"] = repeated[2]
    log.unlink()
    return result


def meets(kind: Kind, result: dict[str, Any]) -> bool:
    """Whether one run is within its kind's limits."""
    return (
        abs(result["ticks"] / result["expected_ticks"] - 1) <= kind.ticks_within
        and result["ring_dropped"] == 0
        and result["sequence_gaps"] == 0
        and result["fresh"] >= kind.fresh
        and result["mismatches"] == 0
    )


def line(kind: Kind, result: dict[str, Any]) -> str:
    late = result["lateness_us"]
    return (
        f"{kind.peer:14s} {kind.rate_hz:5d} Hz {result['ticks']:7d} of "
        f"{result['expected_ticks']:7d} ticks, {result['late']:5d} late, p50 {late['p50']:6.0f} "
        f"p99 {late['p99']:7.0f} max {late['max']:8.0f} us, fresh {100 * result['fresh']:6.2f} %, "
        f"gaps {result['sequence_gaps']}, dropped {result['ring_dropped']}, trips "
        f"{result['watchdog_trips']}, mismatches {result['mismatches']}, steal "
        f"{result['steal_ms']:.0f} ms: "
        + (("meets" if meets(kind, result) else "MISSES") if kind.gates else "for comparison")
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--share", type=float, default=1.0)
    parser.add_argument("--out", type=Path, default=Path("build/bench-host.json"))
    options = parser.parse_args()
    found, passed = [], True
    with tempfile.TemporaryDirectory() as scratch:
        base = Path(scratch)
        folders = {}
        for rate_hz in (1000, 4000):
            folders[rate_hz] = base / f"c{rate_hz}"
            emit(scene(), model_file(base, model_at(rate_hz)), folders[rate_hz])
        for full in KINDS:
            kind = replace(full, seconds=full.seconds * options.share)
            results = []
            for _ in range(min(kind.runs, options.runs)):
                results.append(run(kind, folders[kind.rate_hz], base / "log.h5"))
                print(line(kind, results[-1]), flush=True)
            found.append({"kind": kind.__dict__, "runs": results})
            good = sum(meets(kind, result) for result in results)
            passed &= not kind.gates or 3 * good >= 2 * len(results)
    options.out.parent.mkdir(exist_ok=True)
    options.out.write_text(json.dumps(found, indent=2))
    print("all kinds pass" if passed else "a kind misses its limits in more than one of three runs")
    sys.exit(0 if passed else 1)


if __name__ == "__main__":
    main()
