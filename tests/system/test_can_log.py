"""examples/can_log.py: frames of the tool alone, in the units of the data base."""

from pathlib import Path

import can
import cantools
import numpy as np
import pytest
from can_log import read_can_log

from springpot.codegen.arrays import Samples

DBC = """VERSION ""
BU_: Rig
BO_ 291 Tool: 4 Rig
 SG_ Position : 0|16@1- (0.001,0) [-32|32] "mm" Rig
 SG_ Force : 16|16@1- (0.01,0) [-327|327] "N" Rig
"""
TIME_S = np.arange(0.0, 4.0, 2e-3)
DEPTH_MM = 2.0 - 2.0 * np.cos(2.0 * np.pi * TIME_S)
FORCE_N = 3.0 * DEPTH_MM


def write_log(folder: Path, others: list[tuple[int, bool, str]], size: int = 4) -> Path:
    """Write the tool's frames on can0; between them frames of 9 N, of (number, extended, bus)."""
    (folder / "rig.dbc").write_text(DBC)
    tool = cantools.database.load_string(DBC, "dbc").get_message_by_name("Tool")
    with can.Logger(str(folder / "drive.log")) as log:
        for time_s, depth_mm, force_n in zip(TIME_S, DEPTH_MM, FORCE_N, strict=True):
            for number, extended, bus, newtons in [
                (291, False, "can0", force_n),
                *((*other, 9.0) for other in others),
            ]:
                data = tool.encode({"Position": depth_mm, "Force": newtons})
                log(can.Message(timestamp=100.0 + time_s, arbitration_id=number, channel=bus,
                                is_extended_id=extended, data=data[:size]))  # fmt: skip
    return folder / "drive.log"


def largest_error_n(press: Samples) -> float:
    return float(np.abs(press - FORCE_N[: len(press)]).max())


def test_an_extended_frame_of_the_same_number_is_another_message(tmp_path: Path) -> None:
    log = write_log(tmp_path, [(291, True, "can0"), (292, False, "can0")])
    press = read_can_log(str(log), str(tmp_path / "rig.dbc"), "Tool", 500.0)
    assert len(press.force_n) == len(TIME_S) and largest_error_n(press.force_n) < 0.006
    assert press.position_m.max() == pytest.approx(4e-3, abs=1e-6)


def test_of_two_buses_one_is_chosen(tmp_path: Path) -> None:
    log, database = str(write_log(tmp_path, [(291, False, "can1")])), str(tmp_path / "rig.dbc")
    with pytest.raises(SystemExit, match=r"channels \['can0', 'can1'\]: choose one, --channel"):
        read_can_log(log, database, "Tool", 500.0)
    press = read_can_log(log, database, "Tool", 500.0, channel="can0")
    assert largest_error_n(press.force_n) < 0.006


def test_short_frames_are_refused(tmp_path: Path) -> None:
    log = write_log(tmp_path, [], size=3)
    with pytest.raises(SystemExit, match="2000 frames of Tool have fewer than 4 bytes"):
        read_can_log(str(log), str(tmp_path / "rig.dbc"), "Tool", 500.0)
