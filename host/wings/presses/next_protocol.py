"""The presses to record next: in words, as JSON values, and as a protocol that `record` takes."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from springpot import DataError, Model, Recording, UsageError
from springpot.host.wings.presses.coverage import find_coverage
from springpot.host.wings.presses.next_places import (
    places_of,
    places_words,
    write_lines,
    write_places,
)
from springpot.host.wings.presses.next_presses import NextPress, next_presses
from springpot.modelling import contact_of, hold_spikes

_SUFFIX = ".toml"
_NONE = "not known: no force of these recordings lasts longer than a glitch"


def require_surface(path: Path, recordings: Sequence[Recording]) -> None:
    """Raise UsageError where no protocol can be written: it would press from another zero."""
    if path.suffix != _SUFFIX:
        raise UsageError(f"--next {path}: protocols end in {_SUFFIX}: give a name like x{_SUFFIX}")
    if contact_of([hold_spikes(recording)[0] for recording in recordings]) == "always":
        raise UsageError(
            f"--next {path}: in these recordings the tool never leaves the object, and a protocol "
            "presses from 0 N: leave --next out, the presses are printed"
        )


def profile_metadata(press: NextPress) -> dict[str, Any]:
    """Keys of a protocol's [[profile]]."""
    more = ("hold_s", "rise_s") if press.hold_s else ("frequency_hz", "cycles")
    return {name: getattr(press, name) for name in ("amplitude_n", *more)}


def write_protocol(path: Path, presses: Sequence[NextPress]) -> None:
    """Write a protocol of these presses. Raises UsageError where the file cannot be written."""
    if not presses:
        raise DataError(f"--next {path}: {_NONE}: record longer presses")
    lines: list[str] = []
    for press in presses:
        lines += ["", "[[profile]]"]
        lines += [f"{key} = {value:g}" for key, value in profile_metadata(press).items()]
    write_lines(path, lines)


def next_told(
    recordings: Sequence[Recording], model: Model, path: Path | None
) -> tuple[dict[str, Any], str]:
    """Return JSON values by their keys, and words; write a protocol if there is a path.

    Of a model with a map they are places, of another one presses. Raises as `write_protocol`.
    """
    places_m = places_of(recordings, model)
    if len(places_m):
        if path is not None:
            write_places(path, places_m)
        return {"next_places_m": places_m.tolist()}, places_words(places_m, path)
    presses = next_presses(recordings, find_coverage(recordings).band_hz)
    if path is not None:
        write_protocol(path, presses)
    return {"next_presses": next_metadata(presses)}, next_words(presses, model.contact, path)


def next_metadata(presses: Sequence[NextPress]) -> list[dict[str, Any]]:
    """JSON values: of each press, and how far models differ before and after it is recorded."""
    return [
        profile_metadata(press)
        | {"disagreement_before_n": press.before_n, "disagreement_after_n": press.after_n}
        for press in presses
    ]


def next_words(presses: Sequence[NextPress], contact: str, path: Path | None) -> str:
    """A line a press, and what to do with them."""
    if not presses:
        return _NONE
    lines = [
        f"models that fit these recordings equally well differ by {presses[0].before_n:.2g} N over "
        "what a hand may do:"
    ]
    lines += [f"{_press_words(press)} leaves {press.after_n:.2g} N" for press in presses]
    if contact == "always":
        lines.append("counted from the lowest recorded force")
    elif path is None:
        lines.append("--next FILE.toml writes them as a protocol for springpot record")
    else:
        lines.append(
            f"springpot record --protocol {shlex.quote(str(path))} --device URL --out FOLDER"
        )
    return "\n".join(lines)


def _press_words(press: NextPress) -> str:
    if press.hold_s:
        return f"hold {press.amplitude_n:g} N for {press.hold_s:g} s"
    cycles = f"{press.cycles} cycle" + ("s" if press.cycles > 1 else "")
    return f"{cycles} to {press.amplitude_n:g} N at {press.frequency_hz:g} Hz"
