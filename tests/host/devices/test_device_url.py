"""Device addresses taken apart, and their settings as numbers."""

import dataclasses

import pytest
from support.messages import refusing

from springpot.codegen.errors import UsageError
from springpot.host.devices.device import DeviceRequirements
from springpot.host.devices.drivers import Address, open_device, parse_device
from springpot.host.devices.virtual import parse_url


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
