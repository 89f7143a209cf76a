"""Errors that a user can act on. Each message is one line: what, where, what to do."""


class SpringpotError(Exception):
    """Base of all errors shown to a user; `exit_status` is what the command line returns."""

    exit_status = 1


class UsageError(SpringpotError):
    """A wrong option, scene key or combination of them."""

    exit_status = 2


class DataError(SpringpotError):
    """A recording or model file that cannot be used as it is."""

    exit_status = 3


class BudgetError(SpringpotError):
    """The emitted C does not fit the scene's flash, RAM or time."""

    exit_status = 4


class DeviceError(SpringpotError):
    """A device that cannot be opened, or that failed while in use."""

    exit_status = 5


class UnsafeError(SpringpotError):
    """A scene whose loop is unstable: refused."""

    exit_status = 6


class MismatchError(SpringpotError):
    """C and its numpy reference gave different bits."""

    exit_status = 7
