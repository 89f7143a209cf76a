"""Coupling mode "auto": mode and gains from the loop with the model, every hand and the encoder."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np

from springpot.codegen.coupling.gains import is_implausible
from springpot.codegen.coupling.linear_loop import CHECKED_HANDS, LinearLoop
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.coupling.loop_margin import (
    LoopMargin,
    LoopOnCircle,
    compute_held_noise_n,
    compute_loop_margin,
    compute_noise_m,
)
from springpot.codegen.coupling.object_tangent import ObjectTangent
from springpot.codegen.messages import counted_noun
from springpot.codegen.scene import Coupling

# Gain margin of the bare loop. Closed loops of the emitted C, scaled towards their limit: at .8 of
# it the worst hand vibrates with 2.6 mm/s at most, at .9 with up to 74.
STIFFNESS_MARGIN_OFF = 1.25
# Gain margin behind a proxy, whose mass and damping the device's own figures blur.
STIFFNESS_MARGIN_PROXY = 1.5
# Expected speed of the tool, from the encoder's noise and steps, that counts as quiet: closed loops
# of the emitted C vibrate with up to 1.5 times what is expected, and a hand may feel 1 mm/s.
QUIET_MPS = 0.7e-3
# Force noise of a proxy that is held, N: more throws the tool off an object that is soft there.
MAX_NOISE_N = 0.06
# Every oscillation keeps at least this fraction of the damping of hand and device.
MIN_DAMPING_FRACTION = 0.25
# Of the stiffest coupling that the linear loop allows; sensors and leaves of trees are not linear.
GAIN_MARGIN = 0.8
_STIFFNESSES_NPM = np.geomspace(10.0, 40_000.0, 56)
_STEPS_PER_DECADE = int(np.searchsorted(_STIFFNESSES_NPM, 10.0 * _STIFFNESSES_NPM[0]))
_DAMPINGS_NSPM = np.geomspace(0.5, 500.0, 61)
_MASSES_KG = (0.003, 0.01, 0.05)  # the lightest first: it passes on the least noise
_SOFTEST = [
    Coupling("proxy", float(_STIFFNESSES_NPM[0]), float(f"{damping_nspm:.3g}"), mass_kg)
    for mass_kg in _MASSES_KG
    for damping_nspm in _DAMPINGS_NSPM
]
_SEARCH_TOLERANCE = 1.01  # of the stiffest
_QUIET_TOLERANCE = 1.05  # of the stiffest that is quiet
_N_DEPTHS = 6  # of the search; its choice is judged at all of them


@dataclass(frozen=True)
class CouplingChoice:
    """A coupling and why. felt_npm: the stiffness that a hand feels on the object's stiffest."""

    coupling: Coupling
    why: str
    felt_npm: float


def select_coupling(
    tangent: ObjectTangent,
    stiffness_npm: float,
    dt_s: float,
    device: LoopDevice,
    smoothing: float,
    stated: Coupling,
) -> CouplingChoice:
    """Select `off` where the bare loop holds the object in every hand and is quiet, else a proxy.

    The proxy is the stiffest that is stable in every hand and delay of CHECKED_HANDS, quiet with
    the stated encoder, and no noisier than the object itself makes it. stiffness_npm: the object's
    greatest secant, of which the hand feels a part through the proxy.
    """
    off = replace(stated, mode="off")
    bare = compute_loop_margin(tangent, off, dt_s, device, smoothing)
    late = f"{counted_noun(device.delay_samples, 'sample')} late"
    bare_text = (
        f"at {1 / dt_s:g} Hz, {late}, the loop without a coupling holds {bare.object_text} "
        f"{bare.gain_margin:.3g} times as stiff (worst: {bare.hand_text})"
    )
    objection = _object_to_bare(bare)
    if not objection:
        return CouplingChoice(off, f"off: auto: {bare_text}", stiffness_npm)
    search = _ProxySearch(tangent, stiffness_npm, dt_s, device, smoothing)
    proxy = search.find_stiffest() or search.find_calmest()
    felt_npm = series_stiffness_npm(proxy.stiffness_npm, stiffness_npm)
    why = (
        f"proxy: auto: {bare_text}, {objection}: "
        f"{proxy.stiffness_npm:g} N/m, {proxy.damping_nspm:g} N s/m, {proxy.mass_kg:g} kg; "
        f"the hand feels {1e-3 * felt_npm:.3g} N/mm"
    )
    return CouplingChoice(proxy, why, felt_npm)


def _object_to_bare(bare: LoopMargin) -> str:
    """Return why the bare loop does not do, so that a coupling is needed; "" if it does."""
    if bare.gain_margin <= STIFFNESS_MARGIN_OFF:
        return f"less than {STIFFNESS_MARGIN_OFF:g}"
    if not bare.is_stable:
        return f"but {bare.pressed_margin:.3g} times beyond the trained depth"
    if bare.vibration_mps > QUIET_MPS:
        return f"but vibrates with {1e3 * bare.vibration_mps:.2g} mm/s of the encoder's noise"
    return ""


class _ProxySearch:
    """Proxies that are stable with every hand and delay of CHECKED_HANDS.

    For an object of up to STIFFNESS_MARGIN_PROXY times the stiffness, and for every softer one.
    """

    def __init__(
        self,
        tangent: ObjectTangent,
        stiffness_npm: float,
        dt_s: float,
        device: LoopDevice,
        smoothing: float,
    ) -> None:
        """Prepare the loops that each candidate is tried in: every checked hand and its delays."""
        searched = tangent.select_depths(_N_DEPTHS)
        self._dt_s, self._noise_m = dt_s, compute_noise_m(device)
        # What the object makes of the encoder's noise by itself no coupling has to better.
        self._max_noise_n = max(MAX_NOISE_N, stiffness_npm * self._noise_m)
        self._margin = partial(
            compute_loop_margin, searched, dt_s=dt_s, device=device, smoothing=smoothing
        )
        self._loads_npm = stiffness_npm * STIFFNESS_MARGIN_PROXY * np.geomspace(0.01, 1.0, 8)
        self._springs = []
        self._circles = []
        for hand, extra_delay in CHECKED_HANDS[::-1]:  # what most often fails comes first
            late = device.with_delay(extra_delay)
            self._springs.append(LinearLoop(dt_s, Coupling("off"), hand, late, smoothing))
            # A mass that swings on any spring loses exp(-b t/2m).
            damping_nspm = hand.damping_nspm + device.viscous_nspm
            mass_kg = hand.mass_kg + device.mass_kg
            radius = math.exp(-MIN_DAMPING_FRACTION * damping_nspm / (2.0 * mass_kg) * dt_s)
            self._circles.append(
                LoopOnCircle.build(searched, dt_s, device, smoothing, hand, extra_delay, radius)
            )

    def find_stiffest(self) -> Coupling | None:
        """Return the stiffest proxy that is stable in every loop, softened by GAIN_MARGIN.

        A proxy is a mass that spring and damper join to the tool; every softer spring, down to a
        tenth of it, has to be stable too. A quiet one (vibration of QUIET_MPS at most, from the
        encoder's noise) comes before any louder one.

        Damping has a window: the object's force is held for a tick, which drives the proxy like a
        negative damper of K dt/2, and the tool's held force bounds it from above. Beyond a gap
        there may be a far stiffer branch, of couplings that only pass the object's own loop on:
        they are stable in part of their range alone, and vibrate with an encoder's steps.
        None if no damping is stable even with the softest spring.
        """
        quiet = loud = None
        for softest in _SOFTEST:
            stiffest = self._find_stiffest_for(softest, quiet.stiffness_npm if quiet else 0.0)
            if stiffest is None:
                continue
            if self._is_quiet(stiffest):
                quiet = stiffest
                continue
            if loud is None or loud.stiffness_npm < stiffest.stiffness_npm:
                loud = stiffest
            quiet = self._find_quiet(stiffest, quiet) or quiet
        stiffest = quiet or loud
        if stiffest is None or is_implausible(_soften(stiffest)):
            return None
        return _soften(stiffest)

    def _is_quiet(self, proxy: Coupling) -> bool:
        return self._margin(_soften(proxy)).vibration_mps <= QUIET_MPS

    def _find_quiet(self, loud: Coupling, than: Coupling | None) -> Coupling | None:
        """Return the stiffest quiet proxy softer than `loud` and stiffer than `than`, or None.

        By bisection; mass and damping stay. When a loud proxy was dropped as a whole, the choice
        fell on one 24 times as soft, on a device that was only less late.
        """
        than_npm = than.stiffness_npm if than else float(_STIFFNESSES_NPM[0])
        low = replace(loud, stiffness_npm=_SEARCH_TOLERANCE * than_npm)
        if low.stiffness_npm >= loud.stiffness_npm or not self._is_quiet(low):
            return None
        while loud.stiffness_npm > _QUIET_TOLERANCE * low.stiffness_npm:
            middle_npm = math.sqrt(low.stiffness_npm * loud.stiffness_npm)
            middle = replace(low, stiffness_npm=middle_npm)
            low, loud = (middle, loud) if self._is_quiet(middle) else (low, middle)
        softer = low.stiffness_npm * np.geomspace(0.1, 1.0, _STEPS_PER_DECADE)
        stable = (self._is_stable(replace(low, stiffness_npm=float(k))) for k in softer)
        return low if all(stable) else None

    def find_calmest(self) -> Coupling:
        """Return the softest proxy that swings least, for an object that none holds."""
        plausible = [proxy for proxy in _SOFTEST if not is_implausible(proxy)]
        return min(plausible, key=lambda proxy: max(self._radii(proxy)))

    def _find_stiffest_for(self, softest: Coupling, than_npm: float) -> Coupling | None:
        """Return the stiffest stable proxy of one mass and damping; None below `than_npm`.

        Stable means: with every softer spring down to a tenth as well. From the top of a grid down;
        then by bisection up to the next point of the grid.
        """
        step = cache(lambda k: replace(softest, stiffness_npm=float(_STIFFNESSES_NPM[k])))
        top = last = len(_STIFFNESSES_NPM) - 1
        lowest = np.searchsorted(_STIFFNESSES_NPM[1:], _SEARCH_TOLERANCE * than_npm, "right")
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
        if compute_held_noise_n(proxy, self._dt_s, self._noise_m) > self._max_noise_n:
            return False
        margins = (circle.gain_margins(proxy).min() for circle in self._circles)
        return all(margin >= STIFFNESS_MARGIN_PROXY for margin in margins)

    def _radii(self, proxy: Coupling) -> Iterator[float]:
        for loop in self._springs:
            yield float(replace(loop, coupling=proxy).swing_radius(self._loads_npm).max())


def _soften(proxy: Coupling) -> Coupling:
    return replace(proxy, stiffness_npm=float(f"{GAIN_MARGIN * proxy.stiffness_npm:.3g}"))


def series_stiffness_npm(one_npm: float, other_npm: float) -> float:
    """Stiffness of two springs in series, N/m."""
    return one_npm * other_npm / (one_npm + other_npm)
