"""examples/can_log.py: frames of the tool alone, in the units of the data base."""

from pathlib import Path

import can
import cantools
import numpy as np
import pytest
from can_log import read_can_log

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


OTHERS = [(291, True, "can0"), (292, False, "can0"), (291, False, "can1")]


@pytest.mark.parametrize("other", OTHERS, ids=str)
def test_the_tool_alone_is_read(other: tuple[int, bool, str], tmp_path: Path) -> None:
    """Neither an extended frame of its number, nor another message, nor a second bus."""
    log, database = str(write_log(tmp_path, [other])), str(tmp_path / "rig.dbc")
    if other[2] == "can1":
        with pytest.raises(SystemExit, match=r"channels \['can0', 'can1'\]: choose one, --channel"):
            read_can_log(log, database, "Tool", 500.0)
    press = read_can_log(log, database, "Tool", 500.0, channel="can0")
    assert np.abs(press.force_n - FORCE_N).max() < 0.006
    assert press.position_m.max() == pytest.approx(4e-3, abs=1e-6)


def test_short_frames_are_refused(tmp_path: Path) -> None:
    log = write_log(tmp_path, [], size=3)
    with pytest.raises(SystemExit, match="2000 frames of Tool have fewer than 4 bytes"):
        read_can_log(str(log), str(tmp_path / "rig.dbc"), "Tool", 500.0)
