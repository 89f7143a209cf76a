"""Errors that a user can act on. Each message is one line: what, where, what to do."""

_MAX_LETTERS = 2000


class SpringpotError(Exception):
    """Base of all errors shown to a user; host/cli.py maps each to an exit status.

    >>> issubclass(DataError, SpringpotError), issubclass(DataError, ValueError)
    (True, True)
    """

    def __str__(self) -> str:
        """One printable line, whatever a file holds that is quoted: terminals obey some bytes."""
        text = super().__str__()
        if len(text) > _MAX_LETTERS:
            text = f"{text[: _MAX_LETTERS - 500]} ... {text[-490:]}"
        return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


class UsageError(SpringpotError, ValueError):
    """A wrong option, argument, scene key or combination of them.

    >>> train([])
    Traceback (most recent call last):
    springpot.codegen.errors.UsageError: no recordings: give at least one
    """


class DataError(SpringpotError, ValueError):
    """A recording or model file that cannot be used as it is.

    >>> Recording("a", [0, 14], [0, 1], 1e-3)
    Traceback (most recent call last):
    springpot.codegen.errors.DataError: a: position_m spans 14 m: are these mm? ...
    """


class BudgetError(SpringpotError):
    """The emitted C does not fit the scene's flash, RAM or time.

    >>> emit("tiny", model=model, scene=Scene(1, "a", "a.spm", budget=Budget(ram_bytes=1)))
    Traceback (most recent call last):
    springpot.codegen.errors.BudgetError: RAM: ...
    """


class DeviceError(SpringpotError):
    """A device that cannot be opened, or that failed while in use.

    >>> Session("c", "serial:///dev/none").__enter__()
    Traceback (most recent call last):
    springpot.codegen.errors.DeviceError: ...
    """


class UnsafeError(SpringpotError):
    """A scene with an unstable loop: refused.

    >>> emit("stiff", model=model, scene=Scene(1, "a", "a.spm", coupling=Coupling("tool", 1e6)))
    Traceback (most recent call last):
    springpot.codegen.errors.UnsafeError: ...
    """


class MismatchError(SpringpotError):
    """C and its numpy reference gave different bits.

    >>> validate("c", recordings).mismatches  # else `springpot validate` ends with this error
    0
    """
