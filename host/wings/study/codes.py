"""Blinding: codes in place of names, other ones for every participant, and the key to them."""

import hashlib
import json
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from springpot import DataError
from springpot.basics import write_file
from springpot.host.wings.study.definition import Study

_LETTERS = "BCDFGHJKLMNPRSTVWXZ"  # no vowels: no words


@dataclass(frozen=True)
class Key:
    """codes: participant -> stimulus name -> code. stickers: real stimulus name -> its sticker."""

    codes: Mapping[str, Mapping[str, str]]
    stickers: Mapping[str, str]
    digest: str

    def code(self, participant: str, stimulus: str) -> str:
        return self.codes[participant][stimulus]

    def stimulus(self, participant: str, code: str) -> str:
        """Return the name behind a code. Raises DataError for none of this participant."""
        for name, its in self.codes[participant].items():
            if its == code:
                return name
        raise DataError(f"participant {participant}: no code {code!r} in the key: another key")


def write_key(file: Path, study: Study, participants: Sequence[str]) -> None:
    """Draw codes and stickers, and write them."""
    real = [stimulus.name for stimulus in study.stimulus if stimulus.real is not None]
    draw = secrets.SystemRandom().sample  # an order that nobody can guess
    numbers = draw(range(1, len(real) + 1), len(real))
    stickers = {name: f"R{number}" for name, number in zip(real, numbers, strict=True)}
    pairs = [a + b for a in _LETTERS for b in _LETTERS if a != b]
    names = [stimulus.name for stimulus in study.stimulus]
    codes = {
        participant: dict(zip(names, draw(pairs, len(names)), strict=True))
        for participant in participants
    }
    content = {"schema": 1, "stickers": stickers, "codes": codes}
    write_file(file, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def read_key(file: Path) -> Key:
    """Read it back. Raises DataError where it is gone or none."""
    try:
        text = file.read_bytes()
        content = json.loads(text)
        codes, stickers = content["codes"], content["stickers"]
    except OSError as error:
        raise DataError(
            f"{file}: cannot be read ({error.strerror}): without the key no trial has a meaning; "
            "take it from your backup"
        ) from None
    except (ValueError, KeyError, TypeError):
        raise DataError(f"{file}: not a key of `springpot study plan`") from None
    return Key(codes, stickers, hashlib.sha256(text).hexdigest())
