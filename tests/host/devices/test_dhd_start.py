"""How a Force Dimension device is found, checked and armed: each refusal names cause and remedy."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from support.peer import peer

from springpot.codegen.errors import DeviceError, UsageError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.dhd_device import DhdDevice
from springpot.host.devices.drivers import open_device

WANTED = DeviceRequirements(rate_hz=1000.0, watchdog_s=0.02, max_n=8.0, presses=True)


def refusal(settings: str = "", *options: str, wanted: DeviceRequirements = WANTED) -> str:
    with peer("dhd_device", *options) as device:
        with pytest.raises((DeviceError, UsageError)) as caught:
            open_device(device.url + settings, wanted)
        # Whatever was refused, and when: it gives no force.
        assert not device.named("zero")
        assert all(event["force_n"] == 0 for event in device.named("stop"))
    return str(caught.value)


@pytest.mark.parametrize(
    ("option", "cause", "remedy"),
    [
        ("--absent", "no Force Dimension device on USB", "check cable and power"),
        ("--in-use", "device already in use", "another program holds it: end that one"),
        ("--unpowered", "it has no power", "switch it on"),
        ("--uncalibrated", "it is not calibrated", "put its pole into the pit"),
        ("--no-watchdog", "the device has no watchdog", "?watchdog=off"),
    ],
)
def test_a_device_that_cannot_be_used(option: str, cause: str, remedy: str) -> None:
    said = refusal("", option)
    assert cause in said and remedy in said and "\n" not in said


@pytest.mark.parametrize(
    ("wanted", "told"),
    [(replace(WANTED, rate_hz=20.0, watchdog_s=0.1, presses=False), "needs at least 63 Hz"),
     (replace(WANTED, force_sign=-1), "leave [device] force_sign out")],
)  # fmt: skip
def test_a_scene_that_the_device_cannot_render(wanted: DeviceRequirements, told: str) -> None:
    """Slower forces would trip it; position and force are of one frame."""
    assert told in refusal(wanted=wanted)


@pytest.mark.realtime  # the peer sends a thousand samples a second, or is refused
@pytest.mark.parametrize(("weight_n", "held_n"), [(0.5, 0.5), (-0.5, 0.5), (0.5, 0.0)])
def test_what_it_is_armed_with(weight_n: float, held_n: float) -> None:
    """The force limit, the mass of a handle that is held up where it renders, the watchdog."""
    wanted = replace(WANTED, examined=held_n == 0.0)
    with peer("dhd_device") as device:
        opened = open_device(f"{device.url}&effector_mass_kg=0.12&weight_n={weight_n}", wanted)
        device.wait_for("start", more=1)  # the first proves the watchdog
        opened.stop()
        stop = device.wait_for("stop", more=1)
        opened.close()
    assert stop["max_force_n"] == pytest.approx(13.0 + held_n)  # and room for gravity
    assert stop["mass_kg"] == 0.12 and stop["watchdog_s"] == pytest.approx(0.02)


@pytest.mark.realtime
def test_without_a_watchdog_where_that_is_accepted() -> None:
    with peer("dhd_device", "--no-watchdog") as device:
        opened = open_device(device.url + "&watchdog=off", WANTED)
        assert "last force may still act" in opened.unreached
        opened.close()
        assert device.wait_for("stop")["force_n"] == 0


@pytest.mark.parametrize(
    ("watchdog_s", "steps"), [(0.02, 160), (0.0201, 161), (125e-6, 1), (0.05, 255)]
)
def test_the_device_s_watchdog_waits_no_less_than_the_scene_s(
    watchdog_s: float, steps: int
) -> None:
    """It counts steps of 125 us, 255 at most: a shorter one would trip where the scene holds."""
    asked: list[int] = []
    functions = SimpleNamespace(
        dhdEnableExpertMode=lambda: 0,
        dhdDisableExpertMode=lambda: 0,
        dhdSetWatchdog=lambda count, _id: asked.append(count) or 0,
    )
    opened = SimpleNamespace(
        _sdk=SimpleNamespace(has=lambda _: True, c=functions), id=0,
        _required=replace(WANTED, watchdog_s=watchdog_s),
    )  # fmt: skip
    DhdDevice._set_watchdog(opened)
    assert asked == [steps]
