"""Staircases: harder after n right answers in a row, easier after a wrong one (Levitt 1971).

They settle where n right answers in a row are as likely as not: at 70.7 % for 2 down, at 79.4 % for
3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from springpot import UsageError


@dataclass(frozen=True)
class Staircase:
    """On levels in rising order, the last one the easiest; starts at a place among them.

    It ends after so many reversals or trials, whichever comes first. The first reversals, while it
    comes down from its start, are not counted in the threshold."""

    levels: tuple[float, ...]
    down: int = 2
    start: int = -1
    reversals: int = 12
    skipped: int = 4
    max_trials: int = 120

    def __post_init__(self) -> None:
        if len(self.levels) < 2 or list(self.levels) != sorted(set(self.levels)):
            raise UsageError("a staircase needs two levels or more, rising")
        if self.down < 1 or not -len(self.levels) <= self.start < len(self.levels):
            raise UsageError(f"staircase: down {self.down} from place {self.start}: no such step")
        if not 0 <= self.skipped < self.reversals or self.max_trials < 1:
            raise UsageError("staircase: more reversals have to be made than are skipped")

    def next_level(self, answers: Sequence[bool]) -> float | None:
        """Return the level of the next trial after these answers, or None at the end."""
        places, turns = self._walk(answers)
        ended = len(turns) >= self.reversals or len(answers) >= self.max_trials
        return None if ended else self.levels[places[-1]]

    def threshold(self, answers: Sequence[bool]) -> float | None:
        """Mean of the levels at reversals, an even number of them; None before there are two."""
        places, turns = self._walk(answers)
        counted = turns[self.skipped : self.reversals]
        counted = counted[len(counted) % 2 :]  # as many tops as valleys
        if not counted:
            return None
        return sum(self.levels[places[i]] for i in counted) / len(counted)

    def _walk(self, answers: Sequence[bool]) -> tuple[list[int], list[int]]:
        """Return the place of every trial and of the next, and the trials at which it turned."""
        place, row, last = self.start % len(self.levels), 0, 0
        places, turns = [place], []
        for trial, right in enumerate(answers):
            row = row + 1 if right else 0
            move = 1 if not right else -1 if row == self.down else 0
            if move:
                row = 0
                if last and move != last:
                    turns.append(trial)
                last = move
                place = min(max(place + move, 0), len(self.levels) - 1)
            places.append(place)
        return places, turns
