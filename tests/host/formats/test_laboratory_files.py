"""Excel workbooks and TDMS files: read as tables are, damaged ones refused in one line."""

from pathlib import Path

import numpy as np
import openpyxl
import pytest
from nptdms import ChannelObject, TdmsWriter
from support.small import DT_S, press, soft_force

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import import_file

POSITION_M = press(1.0)
FORCE_N = soft_force(POSITION_M)
TIME_S = np.arange(len(FORCE_N)) * DT_S


def workbook(path: Path, sheets: tuple[str, ...] = ("Specimen 1",), notes: bool = True) -> Path:
    book = openpyxl.Workbook()
    book.active.append(["Operator", "me"])
    if not notes:
        book.remove(book.active)
    for title in sheets:
        sheet = book.create_sheet(title)
        sheet.append(["Method", "press", None, "of the day"])
        sheet.append([])
        sheet.append(["Prüfzeit", "Standardweg", "Standardkraft"])
        sheet.append(["s", "mm", "N"])
        for row in zip(TIME_S, POSITION_M * 1e3, FORCE_N, strict=True):
            sheet.append([float(value) for value in row])
    book.save(path)
    return path


def test_each_sheet_with_a_table_is_a_recording(tmp_path: Path) -> None:
    file = workbook(tmp_path / "gel.xlsx", ("Specimen 1", "Specimen 2"))
    found = import_file(file, None, "none", None)
    assert [one.name for one in found.recordings] == ["gel-Specimen_1", "gel-Specimen_2"]
    assert "sheet 'Sheet' is no recording, not read" in found.guess
    for one in found.recordings:
        np.testing.assert_allclose(one.position_m, POSITION_M, atol=1e-12)
        np.testing.assert_allclose(one.force_n, FORCE_N, rtol=1e-14)
    (alone,) = import_file(workbook(tmp_path / "one.xlsx"), None, "none", None).recordings
    assert alone.name == "one"


def test_a_wrong_cell_is_named_by_sheet_and_row(tmp_path: Path) -> None:
    file = workbook(tmp_path / "gel.xlsx", notes=False)
    book = openpyxl.load_workbook(file)
    book.active["C105"] = "broken"
    book.save(file)
    with pytest.raises(DataError, match=r"gel\.xlsx, sheet 'Specimen 1', row 105, column 3: 'bro"):
        import_file(file, None, "none", None)
    book.active["C105"], book.active["A105"] = 1.0, 0.0
    book.save(file)
    with pytest.raises(DataError, match="sheet 'Specimen 1', row 105: time goes back"):
        import_file(file, None, "none", None)


def test_a_workbook_without_a_table_or_with_damage_is_refused(tmp_path: Path) -> None:
    file = workbook(tmp_path / "gel.xlsx", ())
    with pytest.raises(DataError, match="sheet 'Sheet': found no column"):
        import_file(file, None, "none", None)
    content = file.read_bytes()
    for cut in (8, len(content) // 2, len(content) - 30):
        file.write_bytes(content[:cut])
        with pytest.raises(DataError, match=r"gel.xlsx: damaged or of another format"):
            import_file(file, None, "none", None)


def tdms(path: Path, **properties: float) -> Path:
    channels = {"Displacement": (POSITION_M * 1e3, "mm"), "Load": (FORCE_N, "N")}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [
                ChannelObject("press", name, values, {"unit_string": unit, **properties})
                for name, (values, unit) in channels.items()
            ]
        )
    return path


def test_a_waveform_has_the_time_of_its_step(tmp_path: Path) -> None:
    file = tdms(tmp_path / "gel.tdms", wf_increment=DT_S)
    found = import_file(file, None, "none", None)
    assert "position = 'press/Displacement' in mm (attribute)" in found.guess
    np.testing.assert_allclose(found.recordings[0].position_m, POSITION_M, atol=1e-12)
    np.testing.assert_array_equal(found.recordings[0].force_n, FORCE_N)
    assert found.recordings[0].dt_s == pytest.approx(DT_S)


def test_channels_without_time_need_a_rate(tmp_path: Path) -> None:
    file = tdms(tmp_path / "gel.tdms")
    with pytest.raises(DataError, match="time has no array; it holds 'press/Displacement'"):
        import_file(file, None, "none", None)
    (found,) = import_file(file, parse_map("time=1000Hz"), "none", None).recordings
    assert found.dt_s == pytest.approx(DT_S)


def test_a_damaged_tdms_file_is_refused(tmp_path: Path) -> None:
    file = tdms(tmp_path / "gel.tdms", wf_increment=DT_S)
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(DataError, match=r"gel.tdms: (damaged or of another|holds no vectors)"):
        import_file(file, None, "none", None)
