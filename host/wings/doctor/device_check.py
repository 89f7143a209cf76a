"""Is a device reached, armed, sampled and of the right sign; if not, why and what to do."""

import numpy as np

from springpot import Device, SpringpotError
from springpot.basics import Samples
from springpot.devices import OPEN_LOOP, driver_of, parse_device, press_step_functions
from springpot.host.wings.doctor.machine_check import Diagnosis
from springpot.loop import (
    COLUMN,
    IDLE,
    LoopRows,
    LoopSettings,
    SessionRunner,
    empty_rows,
    requirements_of,
)
from springpot.simulation import RATE_HZ

PUSH_N, PUSH_S = 1.0, 0.5
_REST_S, _RISE_S = 1.0, 0.1
_WATCHDOG_S = 0.02
_MOVED_M = 0.2e-3  # more than encoder steps and a hand at rest
_FAR_M = 0.03  # nobody holds it: enough
_MISSED = 0.02  # of the samples, on a computer that does something else too
_ALONE = "end other programs; check cable and the device's rate"
_CONSENT = f"allow {PUSH_N:g} N for {PUSH_S:g} s: hold the handle loosely, then --yes"


def check_device(url: str, keys: Device, *, push: bool) -> list[Diagnosis]:
    """Open the device, sample it for a second, and where `push` allows it, push with one newton.

    keys: the scene's [device]. Raises UsageError for a wrong URL.
    """
    probe = _Probe(url, keys)
    reached = "reached and armed"
    watched = parse_device(url).settings.get("watchdog") != "off"
    ends = "ends by itself" if watched else "stays: watchdog=off"
    armed = Diagnosis(reached, True, f"{url}: without this host its force {ends}")
    try:
        at_rest = probe.rows(np.zeros(round(_REST_S * RATE_HZ)))
    except _TrippedError as error:
        return [armed, Diagnosis("samples", False, str(error), _ALONE)]
    except SpringpotError as error:
        cause, _, remedy = str(error).removeprefix(f"{url}: ").rpartition(": ")
        return [Diagnosis(reached, False, cause or remedy, remedy if cause else "")]
    found = [armed, _samples(at_rest)]
    if not push:
        return [*found, Diagnosis("sign of its force", True, "not tried", _CONSENT)]
    try:
        pushed = probe.rows(-_push())
    except SpringpotError as error:
        return [*found, Diagnosis("sign of its force", False, str(error))]
    return [*found, _sign(pushed, url)]


class _TrippedError(SpringpotError):
    """A watchdog ended the force meanwhile."""


class _Probe:
    """Opens the device and lets it follow a command without feedback."""

    def __init__(self, url: str, keys: Device) -> None:
        self._url = url
        self._reversed = keys.force_sign == -1
        self._required = requirements_of(
            keys, rate_hz=RATE_HZ, watchdog_s=_WATCHDOG_S, max_n=PUSH_N, examined=True
        )

    def rows(self, command_n: Samples) -> LoopRows:
        """Rows of a loop that follows the command, N into the object. Raises SpringpotError."""
        steps = press_step_functions(command_n, PUSH_N, OPEN_LOOP)
        settings = LoopSettings(
            1 / RATE_HZ, len(command_n) / RATE_HZ, 1.1 * PUSH_N, reversed=self._reversed
        )
        kept = _Kept()
        runner = SessionRunner(
            steps, self._url, self._required, settings, log=kept, reconnect_s=0.0
        )
        try:
            runner.start()
            for progress in runner.watch(0.02):
                begin_m = kept.table[:1, COLUMN["position_m"]]  # nothing before the first row
                if command_n.any() and np.any(np.abs(progress.depth_m - begin_m) > _FAR_M):
                    runner.stop()
        finally:
            runner.close()
        _, error = runner.why()
        if error is not None:
            raise error
        if runner.state.latched or runner.state.tripped:
            why = runner.device_failure or "a watchdog ended the force: samples came too late"
            raise _TrippedError(why)
        return kept.table


class _Kept:
    """All rows of a loop."""

    def __init__(self) -> None:
        self.table = empty_rows()

    def append(self, rows: LoopRows) -> None:
        self.table = np.concatenate((self.table, rows))


def _samples(rows: LoopRows) -> Diagnosis:
    missed = (rows[:, COLUMN["call"]].astype(int) & IDLE) != 0
    position_m = rows[~missed, COLUMN["position_m"]]
    steps_m = np.abs(np.diff(np.unique(position_m)))
    step = f", steps of {1e6 * steps_m.min():.2g} um" if len(steps_m) else ", at one place"
    seen = (
        f"{len(position_m)} of {len(rows)} at {RATE_HZ} Hz, {1e3 * position_m.mean():.2f} mm{step}"
    )
    fine = bool(missed.mean() <= _MISSED)
    return Diagnosis("samples", fine, seen, "" if fine else _ALONE)


def _sign(rows: LoopRows, url: str) -> Diagnosis:
    what = "sign of its force"
    before = rows[: round(0.3 * RATE_HZ), COLUMN["position_m"]].mean()
    moved_m = rows[-round(0.3 * RATE_HZ) :, COLUMN["position_m"]]
    furthest_m = float(moved_m[np.abs(moved_m - before).argmax()] - before)
    seen = f"{PUSH_N:g} N outwards moved it by {1e3 * furthest_m:+.2f} mm"
    if abs(furthest_m) < _MOVED_M:
        return Diagnosis(what, False, seen, "hold it loosely; is its power on, are its brakes off?")
    if furthest_m < 0:
        return Diagnosis(what, True, f"{seen}: out of the object, as it must", _direction(url))
    if driver_of(url).own_frame:
        return Diagnosis(what, False, f"{seen}: against its force", "hold it more loosely")
    turn = "set [device] force_sign = -1, or sign for a drive"
    return Diagnosis(what, False, f"{seen}: into the object", turn)


def _direction(url: str) -> str:
    """Ask a person to look at the axis of a device whose position and force turn together."""
    if not driver_of(url).own_frame:
        return ""
    into = parse_device(url).settings.get("axis", "-z")
    out = into.removeprefix("-") if into.startswith("-") else f"-{into}"
    return f"it moved to {out}: if that is not away from the object, turn ?axis="


def _push() -> Samples:
    rise = np.linspace(0.0, 1.0, round(_RISE_S * RATE_HZ))
    parts = [np.zeros(round(0.3 * RATE_HZ)), rise, np.ones(round(PUSH_S * RATE_HZ)), rise[::-1]]
    return PUSH_N * np.concatenate(parts)
