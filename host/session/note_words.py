"""What the C says of a tick, in words for who presses."""

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
