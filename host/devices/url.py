"""Device addresses: sim://, replay://, serial://, odrive://, dhd:// and their settings."""

import math
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


@dataclass(frozen=True)
class Address:
    """A device URL, taken apart.

    place: what follows the scheme; for odrive without the interface. settings: the query.
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
    """Take a URL apart. Raises DeviceError for a scheme that no driver serves."""
    parts = urlsplit(url)
    if parts.scheme not in SCHEMES:
        raise DeviceError(
            f"{url}: no driver for {parts.scheme or 'a device without a scheme'!r}: use "
            + "; ".join(SCHEMES.values())
        )
    interface = parts.netloc if parts.scheme == "odrive" else ""
    place = parts.path.removeprefix("/") if interface else parts.netloc + parts.path
    if (not place and parts.scheme != "dhd") or (parts.scheme == "odrive" and not interface):
        raise UsageError(f"{url}: not complete: use {SCHEMES[parts.scheme]}")
    settings = dict(parse_qsl(parts.query, keep_blank_values=True))
    return Address(url, parts.scheme, interface, unquote(place), settings)
