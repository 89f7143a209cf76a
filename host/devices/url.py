"""Device addresses: sim://, replay://, serial://, odrive://, dhd:// and their settings."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote, urlsplit

from springpot.codegen.errors import DeviceError, UsageError

SCHEMES = {
    "sim": "sim://OBJECT, for example sim://ecoflex-00-30?hand=mid",
    "replay": "replay://FILE, a recording",
    "serial": "serial:///dev/ttyACM0?baud=921600",
    "odrive": "odrive://slcan//dev/ttyACM0?node=0, odrive://socketcan/can0?node=0, or "
    "odrive://INTERFACE/CHANNEL?node=0 for another interface of python-can",
    "dhd": "dhd://, the first Force Dimension device, or dhd://1, the second",
}
_ON_BUS = ("odrive", "can")  # an interface stands before the place


@dataclass(frozen=True)
class Address:
    """A device URL, taken apart.

    place: what follows the scheme; on a bus without the interface. settings: the query.
    """

    url: str
    scheme: str
    interface: str
    place: str
    settings: dict[str, str]

    def number(self, key: str, default: float, minimum: float, maximum: float) -> float:
        """Return a setting as a number. Raises UsageError outside minimum .. maximum."""
        text = self.settings.get(key)
        if text is None:
            return default
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not minimum <= value <= maximum:
            raise UsageError(
                f"{self.url}: {key}={text}: give a number between {minimum:g} and {maximum:g}"
            )
        return value

    def require_known(self, known: tuple[str, ...]) -> None:
        """Raise UsageError for a setting that is not among the known ones."""
        for key in self.settings:
            if key not in known:
                raise UsageError(f"{self.url}: no setting {key!r}: use {', '.join(known)}")


def parse_device(url: str) -> Address:
    """Take a device's URL apart. Raises DeviceError for a scheme that no driver serves."""
    return parse_address(url, SCHEMES, "device")


def parse_address(url: str, schemes: Mapping[str, str], what: str) -> Address:
    """Take a URL apart; schemes: an example of each. Raises DeviceError for any other scheme."""
    parts = urlsplit(url)
    if parts.scheme not in schemes:
        raise DeviceError(
            f"{url}: no driver for {parts.scheme or f'a {what} without a scheme'!r}: use "
            + "; ".join(schemes.values())
        )
    on_bus = parts.scheme in _ON_BUS
    interface = parts.netloc if on_bus else ""
    place = parts.path.removeprefix("/") if interface else parts.netloc + parts.path
    if (not place and parts.scheme != "dhd") or (on_bus and not interface):
        raise UsageError(f"{url}: not complete: use {schemes[parts.scheme]}")
    settings = dict(parse_qsl(parts.query, keep_blank_values=True))
    return Address(url, parts.scheme, interface, unquote(place), settings)
