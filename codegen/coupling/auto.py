"""Coupling mode "auto": mode and gains from the object's stiffness, the rate and the delay."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from springpot.codegen.coupling.gains import is_unit_error
from springpot.codegen.coupling.linear_loop import CHECKED_HANDS, Hand, LinearLoop
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.messages import counted_noun
from springpot.codegen.scene import Coupling

# The loop must be stable with an object stiffer than this model by so much.
STIFFNESS_MARGIN_OFF = 1.25
STIFFNESS_MARGIN_PROXY = 1.5
# Of the damping of hand and device, so much must be left of whatever swings.
MIN_DAMPING_FRACTION = 0.25
# Of the stiffest coupling that the linear loop allows; sensors and leaves of trees are not linear.
GAIN_MARGIN = 0.8
_STIFFNESSES_NPM = np.geomspace(10.0, 40_000.0, 56)
_STEPS_PER_DECADE = int(
    np.searchsorted(_STIFFNESSES_NPM, 10.0 * _STIFFNESSES_NPM[0])
)  # steps of it
_DAMPINGS_NSPM = np.geomspace(0.5, 500.0, 61)
_MASSES_KG = (0.003, 0.01, 0.05)  # the lightest first: it passes on the least noise
_SOFTEST = [
    Coupling("proxy", float(_STIFFNESSES_NPM[0]), float(f"{damping_nspm:.3g}"), mass_kg)
    for mass_kg in _MASSES_KG
    for damping_nspm in _DAMPINGS_NSPM
]
_SEARCH_TOLERANCE = 1.01  # of the stiffest


@dataclass(frozen=True)
class CouplingChoice:
    """A coupling and why.

    felt_npm: the stiffness that a hand feels on the object's stiffest. every_hand: whether the
    linear loop is stable with every hand and delay of CHECKED.
    """

    coupling: Coupling
    why: str
    felt_npm: float
    every_hand: bool = True


def select_coupling(
    stiffness_npm: float, dt_s: float, device: LoopDevice, smoothing: float, stated: Coupling
) -> CouplingChoice:
    """Pick for an object of that maximum tangent stiffness.

    `off` where the bare loop is stable with every hand and delay of CHECKED: nothing then stands
    between the hand and the model. Else the stiffest proxy of those that are stable with all of
    them: stiffer with a faster loop, less delay, more damping.
    """

    def loop(coupling: Coupling, hand: Hand, extra_delay: int) -> LinearLoop:
        return LinearLoop(dt_s, coupling, hand, device.with_delay(extra_delay), smoothing)

    off = replace(stated, mode="off")
    limit_npm = min(
        loop(off, hand, extra_delay).max_stiffness_npm() for hand, extra_delay in CHECKED_HANDS
    )
    late = f"{counted_noun(device.delay_samples, 'sample')} late"
    object_text = f"the object's {_format_npmm(stiffness_npm)} at {1 / dt_s:g} Hz, {late}"
    if limit_npm > STIFFNESS_MARGIN_OFF * stiffness_npm:
        limit_text = _format_npmm(limit_npm)
        why = f"off: auto: {object_text}, are below the bare loop's limit of {limit_text}"
        return CouplingChoice(off, why, stiffness_npm)
    search = _ProxySearch(stiffness_npm, dt_s, device, smoothing)
    proxy = search.find_stiffest() or search.find_calmest()
    felt_npm = series_stiffness_npm(proxy.stiffness_npm, stiffness_npm)
    why = (
        f"proxy: auto: {object_text}, pass the bare loop's limit of {_format_npmm(limit_npm)} "
        f"with a margin of {STIFFNESS_MARGIN_OFF:g}: "
        f"{proxy.stiffness_npm:g} N/m, {proxy.damping_nspm:g} N s/m, {proxy.mass_kg:g} kg; "
        f"the hand feels {_format_npmm(felt_npm)}"
    )
    return CouplingChoice(proxy, why, felt_npm, every_hand=max(search.radii(proxy)) < 1.0)


class _ProxySearch:
    """Proxies that are stable with every hand and delay of CHECKED.

    For an object of up to STIFFNESS_MARGIN_PROXY times the stiffness, and for every softer one.
    """

    def __init__(
        self, stiffness_npm: float, dt_s: float, device: LoopDevice, smoothing: float
    ) -> None:
        self._loads_npm = stiffness_npm * STIFFNESS_MARGIN_PROXY * np.geomspace(0.01, 1.0, 8)
        self._loops = []
        for hand, more in CHECKED_HANDS[::-1]:  # what most often fails comes first
            loop = LinearLoop(dt_s, Coupling("off"), hand, device.with_delay(more), smoothing)
            # A mass that swings on any spring loses exp(-b t/2m).
            damping_nspm = loop.hand.damping_nspm + loop.device.viscous_nspm
            mass_kg = loop.hand.mass_kg + loop.device.mass_kg
            max_radius = math.exp(
                -MIN_DAMPING_FRACTION * damping_nspm / (2.0 * mass_kg) * loop.dt_s
            )
            self._loops.append((loop, max_radius))

    def find_stiffest(self) -> Coupling | None:
        """Return the stiffest of which all down to a tenth are stable too, softened by GAIN_MARGIN.

        Damping has a window: the object's force is held for a tick, which drives the proxy like a
        negative damper of K dt/2, and the tool's held force bounds it from above. Beyond a gap
        there may be a far stiffer branch, of couplings that only pass the object's own loop on:
        they are stable in part of their range alone, and vibrate with an encoder's steps.
        None if no damping is stable even with the softest spring.
        """
        best: Coupling | None = None
        for softest in _SOFTEST:
            best = self._find_stiffest_for(softest, best.stiffness_npm if best else 0.0) or best
        if best is None:
            return None
        softer = replace(best, stiffness_npm=float(f"{GAIN_MARGIN * best.stiffness_npm:.3g}"))
        return None if is_unit_error(softer) else softer

    def find_calmest(self) -> Coupling:
        """Return the softest proxy that swings least, for an object that none holds."""
        plausible = [one for one in _SOFTEST if not is_unit_error(one)]
        return min(plausible, key=lambda one: max(self.radii(one)))

    def _find_stiffest_for(self, softest: Coupling, than_npm: float) -> Coupling | None:
        """The stiffest of one mass and damping; None if it is not stiffer than that."""
        step = cache(lambda k: replace(softest, stiffness_npm=float(_STIFFNESSES_NPM[k])))
        top = last = len(_STIFFNESSES_NPM) - 1
        lowest = np.searchsorted(
            _STIFFNESSES_NPM[1:], _SEARCH_TOLERANCE * than_npm, "right"
        )  # of use
        stable = cache(lambda k: self._is_stable(step(k)))
        while top >= lowest:  # that one first: every top from here on needs it
            softer = sorted(
                range(max(top - _STEPS_PER_DECADE, 0), top + 1), key=lambda k: k != lowest
            )
            unstable = next((k for k in softer if not stable(k)), None)
            if unstable is None:
                low, high = step(top), step(min(top + 1, last))
                while high.stiffness_npm > _SEARCH_TOLERANCE * low.stiffness_npm:
                    middle_npm = math.sqrt(low.stiffness_npm * high.stiffness_npm)
                    middle = replace(low, stiffness_npm=middle_npm)
                    low, high = (middle, high) if self._is_stable(middle) else (low, middle)
                return low if low.stiffness_npm > _SEARCH_TOLERANCE * than_npm else None
            top = unstable - 1
        return None

    def _is_stable(self, proxy: Coupling) -> bool:
        return all(r <= most for r, (_, most) in zip(self.radii(proxy), self._loops, strict=True))

    def radii(self, proxy: Coupling) -> Iterator[float]:
        for loop, _ in self._loops:
            yield float(replace(loop, coupling=proxy).swing_radius(self._loads_npm).max())


def series_stiffness_npm(one_npm: float, other_npm: float) -> float:
    """Stiffness of two springs in series, N/m."""
    return one_npm * other_npm / (one_npm + other_npm)


def _format_npmm(stiffness_npm: float) -> str:
    return f"{1e-3 * stiffness_npm:.3g} N/mm"
