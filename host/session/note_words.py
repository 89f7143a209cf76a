"""What the C says of a tick, in words for who presses."""

from collections.abc import Mapping

from springpot.codegen.reference.notes import (
    CLAMPED,
    HELD,
    LATCHED,
    LIMITED,
    OUTSIDE,
    RAMPED,
    RESYNC,
)

NOTE_WORDS = {
    HELD: "no sample: the last one was held",
    RESYNC: "history begins anew here",
    OUTSIDE: "deeper than was recorded",
    CLAMPED: "force kept within its limits",
    RAMPED: "force rising from zero",
    LATCHED: "watchdog: no force until a reset",
    LIMITED: "force held back: faster than a touch",
}
NOTE_NAMES = {HELD: "held", RESYNC: "resync", OUTSIDE: "outside", CLAMPED: "clamped",
              RAMPED: "ramped", LATCHED: "latched", LIMITED: "limited"}  # fmt: skip


def notes_in_words(counts: Mapping[str, int]) -> str:
    """What the C noted; counts: of the ticks with each note, by its name."""
    told = [
        f"{name} {counts[name]} ({NOTE_WORDS[bit]})"
        for bit, name in NOTE_NAMES.items()
        if counts.get(name)
    ]
    return ", ".join(told) or "none"
