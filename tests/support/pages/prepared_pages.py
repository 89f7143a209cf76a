"""What a reader has before the first command of a page, made in a folder."""

from pathlib import Path

import numpy as np
from scipy.io import savemat

from springpot.host.emission.emission import emit
from springpot.host.emission.scene_file import read_scene
from support.pages.job import small_job
from support.small import DT_S, press, soft_force


def rig_files(folder: Path) -> None:
    """What a material scientist has: a table, a Mach-1 text, a MAT file."""
    position_m = np.concatenate([press(0.5, 0.010, 2), press(2.0, 0.008, 4), press(5.0, 0.006, 5)])
    force_n, time_s = soft_force(position_m), np.arange(len(position_m)) * DT_S
    columns = np.column_stack([time_s, 1e3 * position_m, force_n])
    np.savetxt(folder / "test-rig.csv", columns, fmt="%.6f", delimiter=",", comments="",
               header="Time,Extension,Load")  # fmt: skip
    savemat(folder / "rig.mat", {"rig": {"z": 1e3 * position_m, "Fz": force_n}})
    rows = "".join(f"{t:.2f}\t{x:.6f}\t{f:.6f}\n" for t, x, f in
                   zip(0.01 * np.arange(400), 1e3 * press(0.25, 0.004)[::10],
                       soft_force(press(0.25, 0.004))[::10] / 9.80665e-3, strict=True))  # fmt: skip
    head = "<Mach-1 File>\n<Sinusoid>\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf"
    (folder / "Dynamic_data.txt").write_text(f"{head}\n{rows}<END DATA>\n")


def nothing(folder: Path) -> None:
    """For pages that make what they need."""


def few_places(folder: Path) -> None:
    """For the page of places, whose own protocols take minutes: four places."""
    places = "places_m = [[0.0, 0.0], [0.01, 0.0], [0.0, 0.01], [0.01, 0.01]]"
    presses = "".join(f"[[profile]]\namplitude_n = 8.0\nfrequency_hz = {hz}\n" for hz in (0.5, 5.0))
    (folder / "few.toml").write_text(f"{places}\n{presses}")


def emitted_job(folder: Path) -> None:
    small_job(folder)
    emit(read_scene(folder / "scene.toml"), folder / "model.spm", folder / "c")


def eco_job(folder: Path) -> None:
    small_job(folder)
    scene = (folder / "scene.toml").read_text()
    (folder / "eco.toml").write_text(f'{scene}[runtime]\nprefix = "eco"\n')


PREPARED = {
    "explanation/stability.md": small_job,
    "how-to/extend.md": nothing,
    "how-to/game-engine.md": eco_job,
    "how-to/import.md": rig_files,
    "how-to/microcontroller.md": small_job,
    "how-to/places.md": few_places,
    "how-to/record.md": nothing,
    "how-to/run-a-device.md": emitted_job,
    "reference/c.md": small_job,
    "reference/commands.md": small_job,
    "tutorials/embedded-engineer.md": nothing,
    "tutorials/haptics-researcher.md": nothing,
    "tutorials/material-scientist.md": nothing,
}
