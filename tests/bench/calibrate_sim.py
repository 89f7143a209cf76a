"""Find the constants of the simulated silicones and write runtime_c/sim/sim_constants.h.

Run from the repository's folder: `.venv/bin/python tests/bench/calibrate_sim.py`, half a minute.

Two unknowns for each object and variant, force and relaxation, are moved until two figures of
the recorded training protocol agree with their targets to 0.3 %. Nothing else is fitted: the
shapes of the elastic branches and of the relaxation spectrum are stated in sim_material.c.
"""

import argparse
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from springpot.host.devices.virtual import parse_url
from springpot.host.recording import protocols
from springpot.host.simulation import bench as simulated_bench
from springpot.host.simulation.objects import VARIANTS
from springpot.runtime_c import paths

TARGETS = {  # object: (maximum depth over the training protocol, m; loss per cycle at 1 Hz, 10 N)
    "ecoflex-00-10": (0.0177, 0.36),
    "ecoflex-00-30": (0.0145, 0.22),
    "ecoflex-00-50": (0.0104, 0.15),
    "dragon-skin-fx": (0.0075, 0.09),
    "dragon-skin-10": (0.0071, 0.07),
}

HEADER = """\
/* Written by tests/bench/calibrate_sim.py: do not edit. For each object and variant (A, B), what
 * gives Table 1's maximum depth over the training protocol, and a loss per cycle at 1 Hz and 10 N
 * of 0.36, 0.22, 0.15, 0.09, 0.07.
 */
#ifndef SIM_CONSTANTS_H
#define SIM_CONSTANTS_H

typedef struct {
    double branch_n;   /* N, slow force of each elastic branch at 10 mm, before stiffening */
    double relaxation; /* 1, force that relaxes, relative to the slow force */
} sim_calibration;

/* clang-format off */
static const sim_calibration sim_calibrations[5][2] = {
%s};
/* clang-format on */

#endif
"""


def loss_per_cycle(position_m: np.ndarray, force_n: np.ndarray) -> float:
    """Energy dissipated in one press / energy put in up to its maximum depth."""
    deepest = int(np.argmax(position_m))
    put_in = np.trapezoid(force_n[: deepest + 1], position_m[: deepest + 1])
    given_back = -np.trapezoid(force_n[deepest:], position_m[deepest:])
    return float((put_in - given_back) / put_in)


def figures(url: str) -> tuple[float, float]:
    """Maximum recorded depth over the training protocol, m, and loss per cycle at 1 Hz, 10 N."""
    bench = simulated_bench.SimulatedBench(parse_url(url))
    depth_m, loss = 0.0, np.nan
    for profile in protocols.training():
        position_m, force_n = bench.press(profile.command_n)
        depth_m = max(depth_m, float(position_m.max()))
        if (profile.metadata["amplitude_n"], profile.metadata["frequency_hz"]) == (10.0, 1.0):
            loss = loss_per_cycle(position_m, force_n)
    return depth_m, loss


def write_constants(folder: Path, constants: np.ndarray) -> None:
    """Write the header; constants: (object, variant, 2)."""
    rows = "".join(
        "    {"
        + ", ".join(f"{{{float(f'{n:.6g}')!r}, {float(f'{r:.6g}')!r}}}" for n, r in variants)
        + "},\n"
        for variants in constants
    )
    (folder / "sim_constants.h").write_text(HEADER % rows, encoding="utf-8")


def measure(folder: Path, constants: np.ndarray) -> np.ndarray:
    """Build the C of `folder` with the constants; return depths and losses, shaped like them."""
    write_constants(folder, constants)
    simulated_bench.bench_library.cache_clear()
    urls = [[f"sim://{name}?variant={v}" for v in VARIANTS] for name in TARGETS]
    return np.array([[figures(url) for url in row] for row in urls])


def main() -> None:
    """Iterate in a copy of the C; write the repository's header at the end."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    repository_folder = paths.SIM
    targets = np.repeat(np.array(list(TARGETS.values()))[:, None, :], 2, axis=1)
    constants = np.ones_like(targets)
    with tempfile.TemporaryDirectory() as aside:
        os.environ["XDG_CACHE_HOME"] = aside
        paths.SIM = Path(shutil.copytree(repository_folder, Path(aside) / "sim"))
        for _ in range(60):
            found = measure(paths.SIM, constants)
            ratio = found / targets
            if np.abs(ratio - 1).max() < 3e-3:
                break
            # The depth goes about as the force to the power 0.5; more relaxation is more loss,
            # and more force at once.
            relax = np.clip(ratio[..., 1] ** -1.2, 0.6, 1.6)
            stiffer = np.clip(ratio[..., 0] ** 1.8, 0.5, 2.0)
            constants *= np.stack([stiffer, relax], axis=-1)
        else:
            raise SystemExit(f"no agreement after 60 rounds: {ratio}")
    write_constants(repository_folder, constants)
    for name, row in zip(TARGETS, found, strict=True):
        for variant, (depth_m, loss) in zip("ab", row, strict=True):
            print(f"{name} {variant}: {depth_m * 1e3:.2f} mm, loss {loss:.3f}")


if __name__ == "__main__":
    main()
