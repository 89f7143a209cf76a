"""Fractional solids as a continuum of Maxwell branches, whose spectrum is known in closed form.

A fractional derivative is D^r = sin(pi r)/pi * integral of tau^-r s tau/(1 + s tau) d ln tau; that
of a fractional Zener solid, (s T)^r / (1 + (s T)^r), has the spectrum of Cole and Cole (1941).
Trapezoids on log-spaced time constants converge exponentially: no fit, and no weight below 0.
"""

from dataclasses import dataclass

import numpy as np

from springpot.basics import Samples

_PER_DECADE = 2.5
_FASTEST_STEPS = 0.25
_BEYOND = 10.0  # slowest time constant over the longest recording
_FAR, _POINTS = 20.0, 400  # of ln tau beyond the branches: what is left further out is little


@dataclass(frozen=True)
class Solid:
    """A fractional solid under a tool.

    stiffness_npm: at rest. weight: of the fractional part, N s^order/m, or N/m of a Zener solid of
    relaxation time time_s. bias_n: mean of what is left, where position 0 is no surface.
    """

    stiffness_npm: float
    weight: float
    order: float
    time_s: float | None
    bias_n: float = 0.0

    @property
    def coefficient(self) -> float:
        """Coefficient of the derivative, N s^order/m; in a Zener solid, of slow motion."""
        return self.weight * (1.0 if self.time_s is None else self.time_s**self.order)

    @property
    def instant_npm(self) -> float | None:
        """Stiffness of an instant step; None if it grows without end."""
        return None if self.time_s is None else self.stiffness_npm + self.weight

    def dynamic_npm(self, frequency_hz: float) -> float:
        """Return magnitude of the stiffness at a frequency, N/m."""
        s = 2j * np.pi * frequency_hz
        part = s**self.order if self.time_s is None else (s * self.time_s) ** self.order
        share = part if self.time_s is None else part / (1.0 + part)
        return float(abs(self.stiffness_npm + self.weight * share))


@dataclass(frozen=True, eq=False)
class Branches:
    """Time constants, ascending, (n,), s, evenly spaced in their logarithm.

    Within 0.3 % for orders up to 0.7 of the Zener solid: nearer 1 it has but one time constant.
    """

    tau_s: Samples

    @property
    def spacing(self) -> float:
        return float(np.log(self.tau_s[1] / self.tau_s[0]))

    def weights(self, order: float, time_s: float | None) -> tuple[Samples, float]:
        """Return weight of each branch, (n,), and of a spring for those slower than all of these.

        time_s: T of the Zener solid, of weight 1 altogether; None: of the derivative, s^-order.
        """
        reach = self.spacing / 2
        low, high = float(np.log(self.tau_s[0])) - reach, float(np.log(self.tau_s[-1])) + reach
        below = np.linspace(low - _FAR, low, _POINTS)
        above = np.linspace(high, high + _FAR, _POINTS)
        if time_s is None:
            weights = _derivative(np.log(self.tau_s), order) * self.spacing
            slower = _derivative(above, order)
            slow = float(slower[0]) / order
            fast_s = float(_derivative(np.array(low), order)) * np.exp(low) / (1.0 - order)
        else:
            log_time = np.log(time_s)
            weights = _zener(np.log(self.tau_s) - log_time, order) * self.spacing
            slower = _zener(above - log_time, order)
            slow = _slower(order * (high - log_time), order)
            fast_s = np.trapezoid(np.exp(below) * _zener(below - log_time, order), below)
        # Faster branches follow the velocity, as a share of the fastest one here does; slower ones
        # relax at a rate, as a share of the slowest one does.
        weights[0] += fast_s / self.tau_s[0]
        relaxing = float(np.trapezoid(np.exp(-above) * slower, above) * self.tau_s[-1])
        weights[-1] += relaxing
        return weights, slow - relaxing


def branches_for(dt_s: float, longest_s: float) -> Branches:
    """Space branches from a quarter of a time step to ten times the longest recording."""
    fastest_s, slowest_s = _FASTEST_STEPS * dt_s, _BEYOND * longest_s
    count = 2 + int(np.log10(slowest_s / fastest_s) * _PER_DECADE)
    return Branches(np.geomspace(fastest_s, slowest_s, count))


def _derivative(log_tau: Samples, order: float) -> Samples:
    """Return spectrum of s^order at tau."""
    found: Samples = np.sin(np.pi * order) / np.pi * np.exp(-order * log_tau)
    return found


def _zener(log_ratio: Samples, order: float) -> Samples:
    """Return spectrum at tau, log_ratio = ln(tau / T)."""
    far = np.clip(order * np.asarray(log_ratio), -300.0, 300.0)
    found: Samples = np.sin(np.pi * order) / np.pi / (2.0 * (np.cosh(far) + np.cos(np.pi * order)))
    return found


def _slower(far: float, order: float) -> float:
    """Return integral of the spectrum from far = order ln(tau / T) on."""
    half = np.pi * order / 2.0
    return float((half - np.arctan(np.tan(half) * np.tanh(far / 2.0))) / (np.pi * order))
