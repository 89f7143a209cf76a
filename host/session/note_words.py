"""What the C says of a tick, in words for who presses."""

from collections.abc import Mapping

from springpot.codegen.reference import notes

_WORDS = {
    "held": "no sample: the last one was held",
    "resync": "history begins anew here",
    "outside": "beyond what was recorded",
    "clamped": "force kept within its limits",
    "ramped": "force rising after a start or a silence",
    "latched": "watchdog: no force until a reset",
    "limited": "force held back: faster than a touch",
    "energy": "force cut to what the hand has paid for",
}
NOTE_NAMES: dict[int, str] = {getattr(notes, name.upper()): name for name in _WORDS}
NOTE_WORDS = {bit: _WORDS[name] for bit, name in NOTE_NAMES.items()}


def notes_in_words(counts: Mapping[str, int]) -> str:
    """What the C noted; counts: of the ticks with each note, by its name."""
    told = [
        f"{name} {counts[name]} ({words})" for name, words in _WORDS.items() if counts.get(name)
    ]
    return ", ".join(told) or "none"
