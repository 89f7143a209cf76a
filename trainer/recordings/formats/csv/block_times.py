"""Blocks of one file that count on in time: one recording, as the test was."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.sampling import STEP_TOLERANCE

_MAX_NAMED = 6  # blocks in a message


def join_in_time(raws: list[RawChannels]) -> tuple[list[RawChannels], str]:
    """Join blocks that count on in time by one step of both; say what the others became."""
    if len(raws) == 1:
        return raws, ""
    tests = [[raws[0]]]
    for raw in raws[1:]:
        if _counts_on(tests[-1][-1], raw):
            tests[-1].append(raw)
        else:
            tests.append([raw])
    rows = ", ".join(str(raw.line_of(0)) for raw in raws[:_MAX_NAMED])
    rows += ", ..." if raws[_MAX_NAMED:] else ""
    said = f"; {len(raws)} blocks of numbers, from rows {rows} on"
    if len(tests) == 1:
        return [_joined(raws)], f"{said}, which count on in time: one recording"
    found = [
        replace(
            _joined(test),
            name=f"{test[0].name}-{k}",
            details={**test[0].details, "begins_s": float(test[0].time_s[0])},
        )
        for k, test in enumerate(tests, 1)
    ]
    joined = " (those that count on in time joined)" if len(tests) < len(raws) else ""
    return found, f"{said}: recordings {found[0].name} to {found[-1].name}{joined}"


def _counts_on(before: RawChannels, after: RawChannels) -> bool:
    steps_s = [float(np.median(np.diff(raw.time_s))) for raw in (before, after)]
    between_s = float(after.time_s[0] - before.time_s[-1])
    rounding_s = 2.0 * max(before.time_digit_s, after.time_digit_s)
    slack_s = min(rounding_s + STEP_TOLERANCE * steps_s[0], 0.5 * min(steps_s))
    alike = [(raw.details["units"], raw.place_m) for raw in (before, after)]
    return alike[0] == alike[1] and all(abs(between_s - step_s) <= slack_s for step_s in steps_s)


def _joined(raws: Sequence[RawChannels]) -> RawChannels:
    begins = list(accumulate((len(raw.time_s) for raw in raws), initial=0))

    def line_of(sample: int) -> int:
        block = bisect_right(begins, sample) - 1
        return raws[block].line_of(sample - begins[block])

    return replace(
        raws[0],
        time_s=np.concatenate([raw.time_s for raw in raws]),
        position_m=np.concatenate([raw.position_m for raw in raws]),
        force_n=np.concatenate([raw.force_n for raw in raws]),
        line_of=line_of,
    )
