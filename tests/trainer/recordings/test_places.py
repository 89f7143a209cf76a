"""Places of recordings: from files and the command line, and kept."""

from pathlib import Path

import numpy as np
import pytest

from springpot import Recording
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.importing import (
    ImportOptions,
    import_file,
    place_or_columns,
)
from springpot.trainer.recordings.journal import JournalWriter
from springpot.trainer.recordings.recording_file import journal_of, read_journal


def press(name: str, place_m: tuple[float, float] | None, stiffness: float = 400.0) -> Recording:
    t_s = np.arange(2000) / 1000
    force_n = 1.0 - np.cos(np.pi * t_s)
    x_m, y_m = place_m or (None, None)
    return Recording(name, force_n / stiffness, force_n, 1e-3, place_x_m=x_m, place_y_m=y_m)


@pytest.mark.parametrize("place_m", [(0.005, -0.01), None])
def test_a_place_is_kept_in_a_journal(tmp_path: Path, place_m: tuple[float, float] | None) -> None:

    recording = press("press", place_m)
    with JournalWriter(tmp_path / "cut.h5", "cut", 1e-3, "", {}, place_m=place_m) as journal:
        journal.append(recording.position_m, recording.force_n)
    assert read_journal(journal_of(tmp_path / "cut.h5"))[0].place_m == place_m


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize("names", ["x_mm,y_mm", "Stage X (mm),Stage Y (mm)", "across,y_mm"])
def test_columns_of_other_names_are_a_place_if_they_are_named(
    tmp_path: Path, names: str, delimiter: str
) -> None:
    """x and y, in mm, beside z: without them, which column is the position is not known."""
    rows = [[f"{k / 100}", "5", "-10", f"{k % 5}", f"{k % 7}"] for k in range(50)]
    header = ["t_s", *names.split(","), "z_mm", "fz_N"]
    if delimiter == " " and "(" in names:
        header = [f'"{name}"' for name in header]
    (tmp_path / "a.csv").write_text("\n".join(map(delimiter.join, [header, *rows])) + "\n")
    options = ImportOptions(place_m=place_or_columns(names))
    if "across" in names:
        with pytest.raises(DataError, match="no unit of position"):
            import_file(tmp_path / "a.csv", options=options)
        return
    read, _ = import_file(tmp_path / "a.csv", options=options)
    assert read.place_m == pytest.approx((0.005, -0.01))
    with pytest.raises(DataError, match="--place"):
        import_file(tmp_path / "a.csv", options=ImportOptions(place_m=("a", "b")))
