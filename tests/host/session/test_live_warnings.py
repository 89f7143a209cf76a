"""What a session warns of while it runs: rows by hand, and a session deeper than trained."""

from functools import cache

import numpy as np
import pytest
from support.sessions import ended
from support.small import DEPTH_M, passive_model, press, recording, scene

from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import CLAMPED, HELD, OUTSIDE, RAMPED, RESYNC
from springpot.host.native.c_library import COLUMN, NONE, empty_rows
from springpot.host.session.live_warnings import LiveWarnings
from springpot.trainer.recordings.recording_file import read_recording, write_recording

DEEP = "deeper than was recorded"


@cache
def plan():
    return make_plan(passive_model(), scene())


def rows_of(ticks, begin=0, position_m=0.005, notes=0):
    """Rows of a quiet hold, one a millisecond, from tick `begin` on."""
    rows = empty_rows(ticks)
    rows[:, COLUMN["time_s"]] = 1e-3 * np.arange(begin, begin + ticks)
    rows[:, COLUMN["position_m"]] = position_m
    rows[:, COLUMN["returned_n"]] = rows[:, COLUMN["sent_n"]] = 2.0
    rows[:, COLUMN["notes"]] = notes
    return rows


def watched(rows, drain=20):
    """What is said of rows that come so many at a time: lines with their tick, events."""
    said = []
    warnings = LiveWarnings(
        make_plan(passive_model(), scene()), lambda line: said.append((at + drain, line))
    )
    for at in range(0, len(rows), drain):
        warnings.append(rows[at : at + drain])
    return said, warnings.finish()


def test_what_lasts_is_told_once():
    rows = rows_of(6000)
    rows[1000:4000, COLUMN["notes"]] = OUTSIDE
    rows[1000:4000, COLUMN["position_m"]] = np.linspace(0.0121, 0.0134, 3000)
    rows[4000:, COLUMN["position_m"]] = np.linspace(0.0134, 0.005, 2000)
    said, events = watched(rows)
    ((at, first),) = said
    assert 1000 < at <= 1100
    assert first.endswith("s: warning: deeper than was recorded, 12.12 of 12 mm")
    assert events == [{"time_s": 1.0, "what": "deeper than was recorded", "count": 3000}]


def test_what_belongs_to_a_session_is_no_warning():
    rows = rows_of(2000)
    rows[0, COLUMN["notes"]] = RESYNC | RAMPED
    rows[100:150, COLUMN["notes"]] = RAMPED
    rows[::100, COLUMN["notes"]] = HELD  # one lost sample in a hundred
    rows[500:600, COLUMN["notes"]] = CLAMPED  # at the lower limit: it does not pull
    rows[500:600, COLUMN["returned_n"]] = 0.0
    rows[700:900, COLUMN["notes"]] = OUTSIDE  # paused: there was no call
    rows[700:900, COLUMN["call"]] = NONE
    rows[1000, COLUMN["notes"]] = -1  # an error, no notes
    assert watched(rows) == ([], [])


def test_a_fast_press_is_told_and_a_glitch_or_free_air_is_not():
    trained_mps = passive_model().trained.max_mps
    fast = 5.0 * trained_mps * 1e-3 * np.arange(60)
    rows = rows_of(3000)
    rows[1000:1060, COLUMN["position_m"]] = 0.001 + fast
    rows[1060:, COLUMN["position_m"]] = 0.001 + fast[-1]
    said, events = watched(rows)
    assert [event["what"] for event in events] == ["faster than four times the recorded speed"]
    assert 40 <= events[0]["count"] <= 80
    assert f"{5 * trained_mps:.4g} of {4 * trained_mps:.4g} m/s" in said[0][1]
    rows[:, COLUMN["position_m"]] -= 1.0  # the same in free air
    assert watched(rows) == ([], [])
    slower = rows_of(3000)
    slower[1000:1060, COLUMN["position_m"]] = 0.001 + 0.7 * fast
    slower[1060:, COLUMN["position_m"]] = 0.001 + 0.7 * fast[-1]
    assert watched(slower) == ([], [])
    glitch = rows_of(3000)
    glitch[500, COLUMN["position_m"]] = 0.5
    glitch[500, COLUMN["notes"]] = HELD
    assert watched(glitch) == ([], [])


def test_a_session_deeper_than_trained_warns_and_its_log_keeps_it(folder, tmp_path):
    """A recording a third deeper than the training, through the whole session."""
    deep = np.concatenate([np.zeros(200), press(1.0, 1.33 * DEPTH_M), np.zeros(800)])
    write_recording(tmp_path / "deep.h5", recording("deep", deep))
    said = []
    log = tmp_path / "log.h5"
    session = ended(folder, f"replay://{tmp_path}/deep.h5", log, alarm=said.append)
    warnings = session.result()["warnings"]
    deeper = [item for item in warnings if item["what"] == DEEP]
    read = read_recording(log)
    outside = (read.channels["notes"].astype(int) & OUTSIDE) > 0
    outside &= (read.channels["call"].astype(int) & NONE) == 0
    assert len(deeper) == 1
    assert deeper[0]["count"] == outside.sum() > 200
    assert deeper[0]["time_s"] == pytest.approx(
        read.channels["time_s"][np.argmax(outside)], abs=1e-3
    )
    assert any(DEEP in line for line in said)
    assert read.details["end"]["warnings"] == warnings
