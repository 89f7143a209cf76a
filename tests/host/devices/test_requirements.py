"""Addresses taken apart, what a session asks of a device, and the line on one that is too weak."""

import dataclasses
from typing import Any

import pytest
from hypothesis import given, strategies as st
from support.messages import refusing

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.scene import Device
from springpot.host.devices.device import (
    DeviceRequirements,
    requirements_from_keys,
    round_down,
    weakness_sentence,
)
from springpot.host.devices.drivers import Address, open_device, parse_device
from springpot.host.devices.virtual import parse_url


@given(st.floats(1e-9, 1e9))
def test_a_limit_has_three_digits_and_is_within_what_it_limits(value: float) -> None:
    named = float(round_down(value))
    assert named <= value * (1 + 1e-11) and named > value * (1 - 0.0101)
    assert named == float(f"{named:.3g}") and round_down(named) == round_down(value)


# Of every key of [device] that a driver reads: a value that is not its default.
KEYS: dict[str, Any] = {
    "m_per_turn": 0.02, "sign": -1, "force_sign": -1, "zero_turns": 0.25, "max_torque_nm": 1.5,
    "nm_per_a": 0.03, "effector_mass_kg": 0.4, "weight_n": 0.7,
}  # fmt: skip


def test_a_driver_gets_the_keys_of_the_scene_as_they_stand() -> None:
    asked: dict[str, Any] = {
        "rate_hz": 2000.0, "watchdog_s": 0.03, "max_n": 9.0, "presses": True,
        "senses": True, "examined": True,
    }  # fmt: skip
    device = Device(surface_mm=3.0, mass_kg=5.0, **KEYS)
    required = requirements_from_keys(device, **asked)
    assert dataclasses.asdict(required) == {**KEYS, **asked, "surface_m": pytest.approx(0.003)}


def test_without_keys_nothing_is_scaled_turned_moved_or_held_up() -> None:
    required = requirements_from_keys(Device(), rate_hz=1000.0, watchdog_s=0.02, max_n=12.0)
    assert required == DeviceRequirements(1000.0, 0.02, 12.0)
    assert dataclasses.asdict(required) == {
        "rate_hz": 1000.0, "watchdog_s": 0.02, "max_n": 12.0, "presses": False,
        "senses": False, "examined": False, "surface_m": 0.0, "m_per_turn": None,
        "sign": 1, "force_sign": 1, "zero_turns": 0.0, "max_torque_nm": None, "nm_per_a": None,
        "effector_mass_kg": None, "weight_n": 0.0,
    }  # fmt: skip
    assert repr(required) == "DeviceRequirements(rate_hz=1000.0, watchdog_s=0.02, max_n=12.0)"
    with pytest.raises(dataclasses.FrozenInstanceError):
        required.sign = -1  # type: ignore[misc]


def test_a_device_that_is_too_weak_is_refused_with_the_key_that_limits_the_force() -> None:
    required = DeviceRequirements(1000.0, 0.02, 12.0)
    line = "x://: gives 5.678 N and the scene up to 12 N: set guard.max_force_n = 5.67"
    for other in ("", ", or take another gear"):
        error = weakness_sentence(
            "x://", "gives 5.678 N", required, 5.678, *([other] if other else [])
        )
        assert isinstance(error, DeviceError) and str(error) == line + other


@pytest.mark.parametrize(
    ("url", "parts"),
    [
        ("sim://ecoflex-00-30?hand=mid", ("sim", "", "ecoflex-00-30", {"hand": "mid"})),
        ("replay:///a/b%20c.h5", ("replay", "", "/a/b c.h5", {})),
        ("replay://a/b.h5", ("replay", "", "a/b.h5", {})),
        ("serial:///dev/x?baud=9600&a=", ("serial", "", "/dev/x", {"baud": "9600", "a": ""})),
        ("odrive://slcan//dev/x?node=1", ("odrive", "slcan", "/dev/x", {"node": "1"})),
        ("odrive://socketcan/can0", ("odrive", "socketcan", "can0", {})),
        ("dhd://", ("dhd", "", "", {})),
        ("dhd://1?axis=-z", ("dhd", "", "1", {"axis": "-z"})),
    ],
)
def test_an_address_has_scheme_interface_place_and_settings(url: str, parts: tuple) -> None:
    assert parse_device(url) == Address(url, *parts)
    assert repr(parse_device(url)).startswith(f"Address(url={url!r}, scheme={parts[0]!r}, ")


def test_settings_are_numbers_within_their_limits() -> None:
    address = parse_device("sim://x?a=1&b=2&c=nan&d=x&e=1.5&f=inf")
    assert address.number("none", 7.0, 1, 2) == 7.0
    assert [address.number(key, 7.0, 1, 2) for key in "abe"] == [1.0, 2.0, 1.5]
    for key, text in (("c", "nan"), ("d", "x"), ("f", "inf")):
        with refusing(UsageError, f"{address.url}: {key}={text}: give a number between 1 and 2"):
            address.number(key, 7.0, 1, 2)
    for low, high in ((1.001, 2), (0, 0.999)):
        with pytest.raises(UsageError):
            address.number("a", 7.0, low, high)
    with pytest.raises(dataclasses.FrozenInstanceError):
        address.place = "y"  # type: ignore[misc]


@pytest.mark.parametrize(
    ("query", "told"),
    [("q=1", "use variant"), ("hand=none", "give one of mid, firm, light"), ("x=0.1", "leave x"),
     ("seed=1.5", "give a whole number"), ("seed=2147483648", "between 0 and 2147483647"),
     ("rate=300", "a whole part of that")],
)  # fmt: skip
def test_what_a_simulated_object_has_not(query: str, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        parse_url(f"sim://ecoflex-00-30?{query}")
    for url in ("sim://none", "sim://mullins?variant=b"):
        with pytest.raises(UsageError, match="mullins"):
            parse_url(url)


def test_a_weight_that_a_device_cannot_hold() -> None:
    required = DeviceRequirements(1000.0, 0.02, 8.0, weight_n=0.5)
    with pytest.raises(UsageError, match=r"leave \[device\] weight_n out"):
        open_device("serial:///dev/none", required)
