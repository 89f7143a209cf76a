"""Addresses of devices and sensors, SCHEME://PLACE?SETTINGS, taken apart."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote, urlsplit

from springpot.codegen.errors import DeviceError, UsageError
from springpot.codegen.messages import short_repr


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
    __repr__ = short_repr

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


def parse_address(
    url: str,
    schemes: Mapping[str, str],
    what: str,
    on_bus: Collection[str] = (),
    has_default: Collection[str] = (),
) -> Address:
    """Take a URL apart.

    schemes: an example of each. on_bus: schemes whose first part is a bus's interface.
    has_default: schemes that need no place.
    Raises DeviceError for any other scheme, UsageError for a URL that is not complete.
    """
    parts = urlsplit(url)
    if parts.scheme not in schemes:
        raise DeviceError(
            f"{url}: no driver for {parts.scheme or f'a {what} without a scheme'!r}: use "
            + "; ".join(schemes.values())
        )
    needs_interface = parts.scheme in on_bus
    interface = parts.netloc if needs_interface else ""
    place = parts.path.removeprefix("/") if interface else parts.netloc + parts.path
    if (not place and parts.scheme not in has_default) or (needs_interface and not interface):
        raise UsageError(f"{url}: not complete: use {schemes[parts.scheme]}")
    settings = dict(parse_qsl(parts.query, keep_blank_values=True))
    return Address(url, parts.scheme, interface, unquote(place), settings)
