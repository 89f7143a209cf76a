"""The reference of what leaves: sp_output.h, tick by tick."""

from springpot.codegen.plan.plan import Plan
from springpot.codegen.reference.notes import CLAMPED, HELD, LATCHED, LIMITED, RAMPED
from springpot.codegen.types import Scalar


class Output:
    """Keep the force of the last call, and bound the next one by it."""

    def __init__(self, plan: Plan) -> None:
        self._config = plan.output
        self._real = plan.dtype
        self.given: Scalar = self._real(0)
        self._share: Scalar = self._real(0)
        self._rise: Scalar = self._real(0)

    def restart(self) -> None:
        """The ramp begins again."""
        self._share, self._rise = self._real(0), self._config.rise

    def free(self) -> None:
        """No contact."""
        self._share = self._real(1)

    def hold(self, latched: Scalar, fall: Scalar, share: Scalar) -> tuple[Scalar, int]:
        """A tick without a good sample; fall: how much of it was latched.

        Force, N, and notes.
        """
        self.given = share * self.given
        if latched:
            return self._fall(fall), LATCHED
        return self.given, HELD

    def force(self, latched: Scalar, after_silence: bool, force: Scalar) -> tuple[Scalar, int]:
        """Return what leaves of the model's force at a good sample, N, and notes."""
        if latched:
            return self._fall(self._real(1)), LATCHED
        note = 0
        if after_silence:
            self._resume(force)
        if self._share < 1:
            force = force * self._share
            self._share = self._share + self._rise * self._real(1)
            note |= RAMPED
        force, clamped = self._clamped(force)
        self.given, limited = self._slewed(force)
        note |= clamped | limited
        return self.given, note

    def _before(self, force: Scalar) -> Scalar:
        given, zero = self.given, self._real(0)
        return max(given, zero) if force > 0 else min(given, zero)

    def _resume(self, force: Scalar) -> None:
        before, now = abs(self._before(force)), abs(force)
        share = before / now if before < now else self._real(1)
        if share < 1 and share < self._share:
            self._rise = self._rise if self._share < 1 else self._config.back
            self._share = share + self._rise

    def _clamped(self, force: Scalar) -> tuple[Scalar, int]:
        min_n, max_n = self._config.min_n, self._config.max_n
        if min_n <= force <= max_n:
            return force, 0
        beyond = min_n if force < min_n else self._real(0)
        return (max_n if force > max_n else beyond), CLAMPED

    def _slewed(self, force: Scalar) -> tuple[Scalar, int]:
        slew = self._config.slew_n * self._real(1)
        before = self._before(force)
        most, least = before + slew, before - slew
        if force > 0:
            return (most, LIMITED) if force > most else (force, 0)
        return (least, LIMITED) if force < least else (force, 0)

    def _fall(self, ticks: Scalar) -> Scalar:
        step = self._config.fall_n * ticks
        down, up = self.given - step, self.given + step
        self.given = down if down > 0 else up if up < 0 else self._real(0)
        return self.given
