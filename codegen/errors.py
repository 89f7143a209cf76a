"""Errors that a user can act on. Each message is one line: what, where, what to do."""

_MAX_LETTERS = 2000


class SpringpotError(Exception):
    """Base of all errors shown to a user; host/cli.py maps each to an exit status."""

    def __str__(self) -> str:
        """One printable line, whatever a file holds that is quoted: terminals obey some bytes."""
        text = super().__str__()
        if len(text) > _MAX_LETTERS:
            text = f"{text[: _MAX_LETTERS - 500]} ... {text[-490:]}"
        return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


class UsageError(SpringpotError, ValueError):
    """A wrong option, argument, scene key or combination of them."""


class DataError(SpringpotError, ValueError):
    """A recording or model file that cannot be used as it is."""


class BudgetError(SpringpotError):
    """The emitted C does not fit the scene's flash, RAM or time."""


class DeviceError(SpringpotError):
    """A device that cannot be opened, or that failed while in use."""


class UnsafeError(SpringpotError):
    """A scene whose loop is unstable: refused."""


class MismatchError(SpringpotError):
    """C and its numpy reference gave different bits."""
