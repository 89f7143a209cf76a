"""A tool of three axes on a Force Dimension device that slides over a map."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.peer import peer
from support.small import scene
from wings.devices.test_dhd_link import MS, PLACE_M, Sdk

from springpot.codegen.errors import UsageError
from springpot.codegen.scene import ScenePlaces
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import open_device
from springpot.host.emission.emission import emit
from springpot.host.native.loop_library import COLUMNS, Stop
from springpot.host.session.session import Session
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.recording_file import read_recording

LUMP = Path(__file__).parents[2] / "golden" / "press" / "lump.spm"


@pytest.fixture(scope="module")
def sliding(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene that slides, emitted."""
    chosen = replace(scene(), places=ScenePlaces("lateral", 8.0, 0.2))
    return emit(chosen, LUMP, tmp_path_factory.mktemp("slide") / "c", accept_unsafe=True).folder


@pytest.mark.parametrize(("axis", "x", "y"), [(2, 0, 1), (0, 1, 2), (1, 2, 0)])
def test_x_and_y_are_the_axes_after_that_of_the_depth(axis: int, x: int, y: int) -> None:
    sdk = Sdk(slides=1, middle_m=(0.1, 0.2), axis=axis, sign=1.0)
    sdk.link.lateral_n[0], sdk.link.lateral_n[1] = 0.3, -0.4
    assert sdk.tick(1, 2.0) == 1
    assert sdk.motion.position_m == PLACE_M[axis]
    assert list(sdk.motion.lateral_m) == pytest.approx([PLACE_M[x] + 0.1, PLACE_M[y] + 0.2])
    force_n = dict(zip((axis, x, y), (-2.0, 0.3, -0.4), strict=True))
    assert sdk.forces[-1] == pytest.approx(tuple(force_n[k] for k in range(3)))


def test_a_link_that_does_not_slide_gives_no_lateral_force() -> None:
    sdk = Sdk()
    sdk.link.lateral_n[0] = 5.0
    sdk.tick(1, 2.0)
    sdk.link.write(sdk.link, 2 * MS, 2.0)
    assert sdk.forces[-1] == (0.0, 0.0, 2.0)


@pytest.mark.parametrize("wrong_n", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("beside", [0, 1])
def test_a_force_that_is_no_number_ends_the_loop_and_reaches_no_motor(
    wrong_n: float, beside: int
) -> None:
    sdk = Sdk(slides=1)
    ffi, c = sdk.library.ffi, sdk.library.c
    slide, ticks = ffi.new("sp_slide *"), []

    def step(_state: object, _position_m: float, _velocity_mps: float, force_n: Any) -> int:
        ticks.append(slide.lateral_n[beside])
        slide.lateral_n[beside] = 0.3 if len(ticks) < 5 else wrong_n
        force_n[0] = 2.0
        return 0

    called = ffi.callback("int(void *, double, double, double *)", step)
    loop, state = sdk.library.memory(c.sp_loop_size(), "sp_loop"), ffi.new("sp_loop_state *")
    rows = np.zeros((1024, len(COLUMNS)))
    config = {"step": called, "period_s": 0.005, "seconds": 2.0, "max_force_n": 8.0,
              "max_depth_m": 1.0, "slide": slide, "state": slide, "cpu": -1, "capacity": 1024,
              "rows": ffi.cast("sp_row *", rows.ctypes.data)}  # fmt: skip
    assert c.sp_loop_start(loop, ffi.new("sp_loop_config *", config), sdk.link) == 0
    c.sp_loop_join(loop)
    c.sp_loop_get_status(loop, state)
    assert state.reason == Stop.FORCE
    assert max(abs(force_n[beside]) for force_n in sdk.forces) == 0.3
    assert np.all(np.isfinite(sdk.forces))
    assert not np.any(sdk.forces[-1])


def test_walls_and_slides_exclude_each_other() -> None:
    slides = DeviceRequirements(1000.0, 0.02, 8.0, middle_m=(0.0, 0.0))
    with peer("dhd_device") as device, pytest.raises(UsageError, match="leave walls_npm out"):
        open_device(f"{device.url}&walls_npm=1000", slides)


@pytest.mark.realtime
def test_a_run_slides_its_log_is_of_the_same_bits_and_it_ends_without_force(
    sliding: Path, tmp_path: Path
) -> None:
    log = tmp_path / "slid.h5"
    with peer("dhd_device", "--sideways-n", 0.4, "--intended-mm", 8, "--presses-hz", 1) as device:
        with Session(sliding, device.url, log, seconds=3.0) as session:
            session.start()
            session.wait()
        end = device.wait_for("stop")
    assert session.error is None
    assert end["force_n"] == 0
    slid = read_recording(log)
    lateral_n = np.hypot(slid.channels["x_n"], slid.channels["y_n"])
    assert lateral_n.max() > 0.1
    assert np.ptp(slid.channels["x_m"]) > 0.002
    middle_m = np.median([slid.channels["x_m"], slid.channels["y_m"]], axis=1)
    assert np.all(np.abs(middle_m - 0.015) < 0.03)  # of the map, at the device's zero
    assert validate(sliding, [slid]).mismatches == 0
    changed = {**slid.channels, "y_n": slid.channels["y_n"].copy()}
    changed["y_n"][np.argmax(lateral_n)] += 1e-3
    assert validate(sliding, [replace(slid, channels=changed)]).mismatches == 1


@pytest.mark.realtime
def test_the_length_of_the_force_ends_a_session_beyond_its_limit(sliding: Path) -> None:
    with peer("dhd_device", "--sideways-n", 2.0, "--intended-mm", 12, "--presses-hz", 1) as device:
        with Session(sliding, device.url, seconds=3.0, max_force_n=1.0) as session:
            session.start()
            session.wait()
        assert device.wait_for("stop")["force_n"] == 0
    assert "1 N" in session.line


@pytest.mark.realtime
def test_a_place_that_is_given_is_held(sliding: Path, tmp_path: Path) -> None:
    log = tmp_path / "held.h5"
    with (
        peer("dhd_device", "--sideways-n", 0.4, "--intended-mm", 8, "--presses-hz", 1) as device,
        Session(sliding, device.url, log, seconds=1.5, place_m=(0.01, 0.011)) as session,
    ):
        session.start()
        session.wait()
    held = read_recording(log)
    assert "x_n" not in held.channels
    assert validate(sliding, [held]).mismatches == 0
