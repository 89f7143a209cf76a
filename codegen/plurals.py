"""Numbers of things in messages."""


def number_of(number: int, what: str) -> str:
    """Write how many there are of what.

    >>> number_of(1, "gap"), number_of(2, "gap")
    ('1 gap', '2 gaps')
    """
    return f"{number} {what}" + ("" if number == 1 else "s")
