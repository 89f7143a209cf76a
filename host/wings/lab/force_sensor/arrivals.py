"""A sensor's own clock against the host's: the line below all arrivals."""

import math


class ArrivalLine:
    """host time = offset + rate * stamp, of the samples that were under way for the least time.

    What delays a sample on its way only ever delays it, so that the clock's line lies below all
    arrivals: of such lines, the one that is nearest to them on average (Paxson 1998). It runs
    through two points of the lower hull, which grows with each sample.
    """

    def __init__(self) -> None:
        self._hull: list[tuple[float, float]] = []
        self._sum_s, self._count = 0.0, 0
        self._edge = 0

    def add(self, stamp_s: float, arrived_s: float) -> None:
        """Take a sample's own time and when it came, s. Stamps must increase."""
        hull = self._hull
        while len(hull) > 1 and not _turns_up(hull[-2], hull[-1], (stamp_s, arrived_s)):
            hull.pop()
        hull.append((stamp_s, arrived_s))
        self._sum_s += stamp_s
        self._count += 1

    def host_s(self, stamp_s: float) -> float:
        """When a sample of this stamp would have come, had nothing held it back, s."""
        hull = self._hull
        if len(hull) < 2:
            return hull[0][1] + stamp_s - hull[0][0] if hull else math.nan
        mean_s = self._sum_s / self._count
        at = min(self._edge, len(hull) - 2)
        while at > 0 and hull[at][0] > mean_s:
            at -= 1
        while at < len(hull) - 2 and hull[at + 1][0] <= mean_s:
            at += 1
        self._edge = at
        (begin, begin_s), (end, end_s) = hull[at], hull[at + 1]
        return begin_s + (end_s - begin_s) / (end - begin) * (stamp_s - begin)


def _turns_up(
    first: tuple[float, float], second: tuple[float, float], third: tuple[float, float]
) -> bool:
    before = (second[1] - first[1]) * (third[0] - second[0])
    return before < (third[1] - second[1]) * (second[0] - first[0])
