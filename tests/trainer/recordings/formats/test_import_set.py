"""Several files of one object: the same recordings from Python and from the command line."""

from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring

import springpot
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.importing import ImportOptions

AUTO = ImportOptions(conditioning=Conditioning(contact_force="auto"))


def write_press(
    file: Path, seed: int, depth_m: float, noise_n: float = 0.02, drift_npmin: float = 0.0
) -> None:
    """A press from 2 mm above a soft spring, by a machine that counts from 5 mm, at 200 Hz."""
    rng, time_s = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.005)
    deep_m = -2e-3 + (depth_m + 2e-3) * 0.5 * (1.0 - np.cos(2.0 * np.pi * time_s / 3.0))
    force_n = 400.0 * np.maximum(deep_m, 0.0) ** 1.3 / 0.01**0.3
    force_n += rng.normal(0.0, noise_n, len(time_s)) + drift_npmin * time_s / 60.0
    columns = np.stack([time_s, 1e3 * (deep_m + 5e-3), force_n], axis=1)
    header = "time_s,position_mm,force_N"
    np.savetxt(file, columns, "%.6f", ",", header=header, comments="")


@pytest.mark.filterwarnings("always::UserWarning")
def test_a_set_is_imported_alike_from_python_and_the_command_line(tmp_path: Path) -> None:
    """Each file by itself found a surface of its own: three times the error."""
    folder = tmp_path / "files"
    folder.mkdir()
    for seed, depth_m in enumerate((2e-3, 5e-3, 8e-3)):
        write_press(folder / f"{seed}.csv", seed, depth_m)
    (folder / "notes.md").write_text("left out")
    spring("import", str(folder), "--contact-force", "auto", "--out", str(tmp_path / "out"))
    by_command = springpot.read_recordings(tmp_path / "out")
    for given in (folder, [folder / f"{k}.csv" for k in range(3)]):
        by_python = springpot.import_recordings(given, options=AUTO)
        for one, other in zip(by_command, by_python, strict=True):
            assert one.position_m.tobytes() == other.position_m.tobytes()
            assert one.force_n.tobytes() == other.force_n.tobytes()
    surfaces = {recording.details["contact_position_m"] for recording in by_command}
    assert len(surfaces) == 1
    (recording, *_), surface_m = by_command, surfaces.pop()
    assert abs(surface_m - 5e-3) < recording.details["contact_uncertainty_m"] < 1e-3


@pytest.mark.filterwarnings("always::UserWarning")
def test_presses_of_one_session_from_python(tmp_path: Path) -> None:
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for seed, file in enumerate(files):
        write_press(file, seed, 5e-3)
    first, second = springpot.import_recordings(files, options=AUTO, rest_s=2.0)
    assert second.start_s == pytest.approx(first.duration_s + 2.0)
    assert first.session == second.session != ""


@pytest.mark.filterwarnings("always::UserWarning")
@pytest.mark.parametrize("noise_n", [0.1, 0.3, 0.6])
def test_a_surface_that_is_not_known_is_refused(tmp_path: Path, noise_n: float) -> None:
    """Noise of 0.3 N on a press of 3 N once put the surface 4 mm too deep, "+- 0.03 mm"."""
    file = tmp_path / "noisy.csv"
    write_press(file, 0, 8e-3, noise_n)
    with pytest.raises(
        DataError, match=r"surface is known to .*: leave Conditioning\(contact_force\) out"
    ):
        springpot.import_recordings(file, options=AUTO)


@pytest.mark.filterwarnings("always::UserWarning")
def test_a_minus_of_typesetters_is_one(tmp_path: Path) -> None:
    write_press(tmp_path / "a.csv", 0, 5e-3)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "b.csv").write_text(text.replace("-", "\u2212"), encoding="utf-8")
    one, other = (springpot.import_recordings(tmp_path / f"{name}.csv")[0] for name in "ab")
    assert one.force_n.min() < 0.0
    assert one.force_n.tobytes() == other.force_n.tobytes()
