"""Real-time sessions on simulated hands, recordings and lossy devices, and what they warn of."""

import ctypes
import os
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.peer import peer, wait_until
from support.sessions import ended, faithful
from support.small import DEPTH_M, model_file, passive_model, press, recording, scene

from springpot import Session, SpringpotError
from springpot.codegen.errors import DataError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.notes import CLAMPED, HELD, LATCHED, OUTSIDE, RAMPED, RESYNC
from springpot.codegen.scene import Guard
from springpot.host.cli import exit_status
from springpot.host.emission.emission import emit
from springpot.host.native.c_library import (
    COLUMN,
    IDLE,
    NONE,
    RESET,
    SILENT,
    UNSENT,
    empty_rows,
    loop_library,
)
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.session import outcome
from springpot.host.session.c_loop import CLoop, StepFunctions
from springpot.host.session.live_warnings import LiveWarnings
from springpot.host.session.outcome import NOTE_WORDS, LoopSettings, LoopState, expected_ticks
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.hdf5_file import write_recording
from springpot.trainer.recordings.recording_file import read_recording


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """The same small scene in both number types."""
    base = tmp_path_factory.mktemp("scenes")
    for number in ("float32", "float64"):
        emit(scene(number), model_file(base), base / number)
    return base


@pytest.fixture
def folder(folders):
    return folders / "float32"


@pytest.fixture
def log(tmp_path):
    return tmp_path / "a.h5"


def calls(file):
    return read_recording(file).channels["call"].astype(int)


@pytest.mark.parametrize("number", ["float32", "float64"])
def test_a_simulated_hand(log, folders, number):
    told, url = [], "sim://ecoflex-00-30?hand=firm&seed=3"
    session = ended(folders / number, url, log, seconds=1.0, report=told.append)
    result = session.result()
    assert abs(result["ticks"] - 1000) <= 1 and result["expected_ticks"] == 1000
    assert result["ring_dropped"] == result["stale_samples"] == result["watchdog_trips"] == 0
    assert told[-1] == "ran for 1 s"
    read = faithful(folders / number, log)
    assert len(read.position_m) == result["ticks"] and read.force_n.max() > 0.5
    assert read.details["end"]["stopped"] == "ran for 1 s"


def test_a_tick_begins_a_session_and_each_of_its_periods():
    expected = [expected_ticks(LoopState(elapsed_s=s), LoopSettings(1e-3)) for s in (0, 4e-4, 1e-2)]
    assert expected == [0, 1, 11]


def test_a_log_that_was_altered_does_not_validate(log, folder):
    """Inputs, forces and notes are compared; forces to the last bit."""
    ended(folder, "sim://ecoflex-00-30", log, seconds=0.5)
    read = faithful(folder, log)
    # A tick whose force was sent in its own period: on a busy machine some are not.
    at = 300 + int(np.flatnonzero(read.channels["call"][300:] == 0)[0])
    for channel, change in (("returned_n", 1e-6), ("input_m", 3e-4), ("notes", 1.0)):
        values = read.channels[channel].copy()
        values[at] += change
        altered = replace(read, channels={**read.channels, channel: values})
        assert validate(folder, [altered], paced_s=0.01).mismatches >= 1, channel
    felt = read.force_n.copy()
    felt[at] += 1e-6
    assert validate(folder, [replace(read, force_n=felt)], paced_s=0.01).mismatches == 1
    call = read.channels["call"].copy()
    call[at] += UNSENT  # what a tick left unsent was not felt, and is no other force
    altered = replace(read, force_n=felt, channels={**read.channels, "call": call})
    found = validate(folder, [altered], paced_s=0.01)
    assert found.mismatches == 0 and found.predicted_n[0][at] == np.float32(felt[at])


def test_a_replay_gives_the_forces_of_validation(tmp_path, log, folder):
    """replay:// runs through the same loop, and ends with the recording."""
    played = recording("press", press(2.0))
    write_recording(tmp_path / "press.h5", played)
    session = ended(folder, f"replay://{tmp_path}/press.h5", log)
    assert "no more samples" in session.line
    returned_n = faithful(folder, log).channels["returned_n"]
    # What the scene returned: a period that began late sends nothing, and the last force stays.
    np.testing.assert_array_equal(returned_n, validate(folder, [played], 0.01).predicted_n[0])
    write_recording(tmp_path / "slow.h5", replace(played, dt_s=0.002))
    with pytest.raises(DataError, match="resample"):
        Session(folder, f"replay://{tmp_path}/slow.h5", report=list).__enter__()


def test_pause_reset_resume_stop(log, folder):
    with Session(folder, "sim://ecoflex-00-30", log, report=list) as session:
        session.start()
        wait_until(lambda: session.state.ticks > 300, 5, "no ticks")
        session.pause()
        wait_until(lambda: session.state.paused, 5, "not paused")
        at = session.state.ticks
        wait_until(lambda: session.state.ticks > at + 100, 5, "no ticks while paused")
        session.resume()
        wait_until(lambda: session.state.resets == 1, 5, "no reset after the pause")
        session.reset()
        wait_until(lambda: session.state.resets == 2, 5, "no reset")
        session.stop()
        assert session.over
    assert session.line == "stopped by the user"
    read, call = faithful(folder, log), calls(log)
    paused = np.flatnonzero(call & NONE)
    assert len(paused) > 100 and np.all(call[paused] & SILENT) and np.all(read.force_n[paused] == 0)
    resets = np.flatnonzero(call & RESET)
    assert resets[0] == paused[-1] + 1 and len(resets) == 2
    assert sum(map(len, session._ticks_s)) == np.count_nonzero((call & (IDLE | NONE)) == 0)


@pytest.mark.realtime
def test_an_exception_ends_it_with_zero_force(log, folder):
    with (
        peer("serial_device", "--presses-hz", 4) as device,
        pytest.raises(ZeroDivisionError),
        Session(folder, device.url, log, report=list) as session,
    ):
        session.start()
        wait_until(lambda: session.state.ticks > 300, 5, "no ticks")
        _ = 1 / 0
    assert session.line == "stopped by ZeroDivisionError"
    assert device.wait_for("stop")["force_n"] == 0
    faithful(folder, log)


def test_limits_end_it_before_the_force_is_sent(tmp_path, folder):
    for limits, says in (({"max_force_n": 0.4}, "force reached"), ({"max_depth_m": 2e-3}, "deep")):
        session = ended(folder, "sim://ecoflex-00-30", log := tmp_path / f"{says}.h5", **limits)
        assert says in session.line and isinstance(session.error, SpringpotError)
        assert session._requirements.max_n <= limits.get("max_force_n", 99)  # of the device
        assert exit_status(session.error) == 1
        read = faithful(folder, log)
        assert read.force_n[-1] == 0 and read.force_n.max() <= limits.get("max_force_n", 99)


@pytest.mark.realtime
def test_python_stands_still_for_300_ms(log, folder):
    """The loop does not care, and the log has every row."""
    with peer("serial_device") as device:
        with Session(folder, device.url, log, seconds=1.5, report=list) as session:
            session.start()
            for _ in range(2):
                wait_until(lambda: session.state.ticks > 100, 5, "no ticks")
                before = session.state.ticks
                ctypes.PyDLL(None).usleep(300_000)  # holds the interpreter's lock
                assert session.state.ticks > before + 290
            session.wait(20)
        stopped_s = device.named("stop")[0]["at_s"]
        assert not [e for e in device.named("tripped") if e["at_s"] < stopped_s]
    result = session.result()
    assert result["ring_dropped"] == result["sequence_gaps"] == result["crc_errors"] == 0
    assert len(faithful(folder, log).position_m) == result["ticks"] >= 1498


@pytest.mark.realtime
def test_damage_on_the_line_is_never_a_force(log, folder):
    harms = "--damage", 0.02, "--drop", 0.02, "--duplicate", 0.05, "--reorder", 0.01
    with peer("serial_device", *harms, "--delay-ms", 0.5) as device:
        session = ended(folder, device.url, log, seconds=1.5)
    result, read = session.result(), faithful(folder, log)
    whole = result["samples"] / 1500  # less where the machine held device or session up
    assert result["crc_errors"] > 10 * whole and result["sequence_gaps"] > 30 * whole
    assert read.position_m.min() + 1e-3 >= 0 and read.position_m.max() < 0.03


WATCHDOG_MS = 200  # longer than a busy machine holds everything up
LOSSES = ("--drop", 0.01, "--late", 0.02, "--presses-hz", 2)


@pytest.mark.realtime
@pytest.mark.parametrize(("device", "mode"), [("serial_device", "proxy"), ("slcan_odrive", "off")])
def test_losses_are_not_felt(tmp_path, log, device, mode):
    folder = tmp_path / "c"
    waits = replace(scene(mode=mode), guard=Guard(watchdog_ms=WATCHDOG_MS))
    emit(waits, model_file(tmp_path), folder, accept_unsafe=True)
    with peer(device, *LOSSES) as lossy:
        session = ended(folder, lossy.url, log, seconds=3.0)
    assert session.line == "ran for 3 s"
    result, read = session.result(), faithful(folder, log)
    call, notes = (read.channels[name].astype(int) for name in ("call", "notes"))
    assert result["watchdog_trips"] == 0 and not np.any(notes & LATCHED)
    assert len(call) == result["ticks"] == pytest.approx(3000, abs=2)
    idle = np.count_nonzero(call & IDLE)
    assert idle >= 10
    # Each sample that came was stepped once, apart from those of periods settled without one
    # while the machine held the peer up.
    if result["lateness_us"]["max"] <= 3000:
        assert result["unused_samples"] <= 40 and idle <= 80
        if device == "serial_device":  # it numbers its frames: only what was lost is missing
            assert abs(idle - result["sequence_gaps"]) <= 4 + result["unused_samples"]
    clean_n = loss_free_n(folder, read)
    known = ((call & (IDLE | NONE)) == 0) & ((notes & RAMPED) == 0) & (read.position_m > 0)
    known[1:] &= known[:-1]
    pressed = known & (clean_n > 0.05 * clean_n.max())
    assert np.count_nonzero(pressed) > 1000
    returned_n = read.channels["returned_n"]
    assert not np.any(pressed & ((returned_n <= 0) | (read.force_n <= 0)))
    steps_n, clean_steps_n = (np.abs(np.diff(n, prepend=n[0])) for n in (returned_n, clean_n))
    assert steps_n[known].max() <= 1.5 * clean_steps_n[known].max() + 0.1


def loss_free_n(folder, read):
    """The scene's force, N, had every sample come: what was lost lies between its neighbours."""
    come = (read.channels["call"].astype(int) & (IDLE | NONE)) == 0
    ticks = np.arange(len(come))
    position_m = np.interp(ticks, ticks[come], read.position_m[come])
    force_n, _ = SceneLibrary(folder).new_state().run(position_m)
    return force_n.astype(float)


DEEP = "deeper than was recorded"


def rows_of(ticks, begin=0, position_m=0.005, notes=0):
    """Rows of a quiet hold, one a millisecond, from tick `begin` on."""
    rows = empty_rows(ticks)
    rows[:, COLUMN["time_s"]] = 1e-3 * np.arange(begin, begin + ticks)
    rows[:, COLUMN["position_m"]] = position_m
    rows[:, COLUMN["returned_n"]] = rows[:, COLUMN["sent_n"]] = 2.0
    rows[:, COLUMN["notes"]] = notes
    return rows


def watched(rows, drain=20):
    """Return warnings on rows, `drain` at a time: lines with their tick, and events."""
    said, plan = [], make_plan(passive_model(), scene())
    warnings = LiveWarnings(plan, lambda line: said.append((at + drain, line)))
    for at in range(0, len(rows), drain):
        warnings.append(rows[at : at + drain])
    return said, warnings.finish()


def test_what_lasts_is_told_once():
    rows = rows_of(6000)
    rows[1000:4000, COLUMN["notes"]] = OUTSIDE
    rows[1000:4000, COLUMN["position_m"]] = np.linspace(0.0121, 0.0134, 3000)
    rows[4000:, COLUMN["position_m"]] = np.linspace(0.0134, 0.005, 2000)
    rows[5000:5200, COLUMN["notes"]] = HELD | LATCHED  # which another message says
    ((at, first), (_, latched)), events = watched(rows)
    assert 1000 < at <= 1100 and latched == ""
    assert first.endswith(f"s: warning: {DEEP}, 12.12 of 12 mm")
    assert events == [{"time_s": 1.0, "what": DEEP, "count": 3000},
                      {"time_s": 5.0, "what": NOTE_WORDS[LATCHED], "count": 200}]  # fmt: skip
    assert watched(rows[:1010])[1] == [{"time_s": 1.0, "what": DEEP, "count": 10}]  # to its end


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
    fast = 5.0 * trained_mps * 1e-3 * np.minimum(np.arange(2000), 59)
    rows, slower, glitch = (rows_of(3000) for _ in range(3))
    rows[1000:, COLUMN["position_m"]] = 0.001 + fast
    said, events = watched(rows)
    assert [event["what"] for event in events] == ["faster than four times the recorded speed"]
    assert 40 <= events[0]["count"] <= 80
    assert f"{5 * trained_mps:.4g} of {4 * trained_mps:.4g} m/s" in said[0][1]
    rows[:, COLUMN["position_m"]] -= 1.0  # the same in free air
    slower[1000:, COLUMN["position_m"]] = 0.001 + 0.7 * fast
    glitch[500, [COLUMN["position_m"], COLUMN["notes"]]] = 0.5, HELD
    assert [watched(each) for each in (rows, slower, glitch)] == 3 * [([], [])]


def test_a_session_deeper_than_trained_warns_and_its_log_keeps_it(folder, log, tmp_path):
    """A recording a third deeper than the training, through the whole session."""
    deep = np.concatenate([np.zeros(200), press(1.0, 1.33 * DEPTH_M), np.zeros(800)])
    write_recording(tmp_path / "deep.h5", recording("deep", deep))
    said, url = [], f"replay://{tmp_path}/deep.h5"
    warnings = ended(folder, url, log, alarm=said.append).result()["warnings"]
    (deeper,) = (item for item in warnings if item["what"] == DEEP)
    read = read_recording(log)
    outside = (read.channels["notes"].astype(int) & OUTSIDE) > 0
    outside &= (read.channels["call"].astype(int) & NONE) == 0
    assert deeper["count"] == outside.sum() > 200
    first_s = read.channels["time_s"][np.argmax(outside)]
    assert deeper["time_s"] == pytest.approx(first_s, abs=1e-3)
    assert any(DEEP in line for line in said) and read.details["end"]["warnings"] == warnings


@pytest.mark.parametrize(("cpus", "chosen"), [({0, 1, 5}, 5), ({3}, -1)])
def test_the_loop_asks_for_the_last_processor_if_one_is_left_for_the_rest(
    cpus: set[int], chosen: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []
    library = loop_library("float")
    loop = CLoop(StepFunctions(library, 0, 0, 0, 0), LoopSettings(1e-3))
    start = SimpleNamespace(sp_loop_start=lambda _loop, config, _link: asked.append(config.cpu))
    monkeypatch.setattr(loop, "_c", start)
    monkeypatch.setattr(loop, "_adopt", lambda device: device)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: cpus)
    loop.start(library.ffi.NULL)
    assert asked == [chosen]


@pytest.mark.parametrize(
    ("line", "steal_ms"), [("cpu 1 2 3 4 5 6 7 80 9 10", 800.0), ("cpu 1", 0.0)]
)
def test_the_time_that_a_hypervisor_took_is_the_eighth(
    line: str, steal_ms: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(outcome.Path, "read_text", lambda *_, **__: f"{line}\nintr 3\n")
    assert outcome.hypervisor_steal_ms() == steal_ms
