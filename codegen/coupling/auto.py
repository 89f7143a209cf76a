"""Coupling mode "auto": mode and gains from the object's stiffness, the rate and the delay."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from springpot.codegen.coupling.linear_loop import HAND_MODELS, Hand, LinearLoop
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.plurals import number_of
from springpot.codegen.scene import Coupling

# The loop must be stable with an object stiffer than this model by so much.
STIFFNESS_MARGIN_OFF = 1.25
STIFFNESS_MARGIN_PROXY = 1.5
# A proxy's oscillations must die out within 0.5 s: 1 - dt/0.5 s is the maximum radius.
DECAY_PER_S = 2.0
# Of the stiffest coupling that the linear loop allows; sensors and leaves of trees are not linear.
GAIN_MARGIN = 0.75
_STIFFNESSES_NPM = np.geomspace(10.0, 40_000.0, 50)
_RATIOS = np.array([0.6, 1.0, 1.6])  # of the proxy's critical damping
_MASSES_KG = (0.02, 0.05, 0.1)


@dataclass(frozen=True)
class CouplingChoice:
    """A coupling and why.

    felt_npm: the stiffness that a hand feels on the object's stiffest. every_hand: whether the
    linear loop is stable with every hand, at the stated delay and one sample more.
    """

    coupling: Coupling
    why: str
    felt_npm: float
    every_hand: bool = True


def choose_coupling(
    stiffness_npm: float, dt_s: float, device: LoopDevice, smoothing: float, stated: Coupling
) -> CouplingChoice:
    """Pick for an object of that maximum tangent stiffness.

    `off` where the bare loop is stable with every hand at the stated delay, and with the mid and
    firm hands at one sample more: nothing then stands between the hand and the model. `why` says
    where the light hand's limit at one sample more is less. Else the stiffest proxy that is stable
    with every hand at both delays.
    """

    def loop(coupling: Coupling, hand: Hand, more: int) -> LinearLoop:
        return LinearLoop(dt_s, coupling, hand, device.later(more), smoothing)

    off = replace(stated, mode="off")
    bare = [
        (hand, more) for hand in HAND_MODELS for more in (0, 1) if more == 0 or hand.name != "light"
    ]
    limits = [loop(off, hand, more).max_stiffness_npm() for hand, more in bare]
    late = f"{number_of(device.delay_samples, 'sample')} late"
    found = f"the object's {_npmm(stiffness_npm)} at {1 / dt_s:g} Hz, {late}"
    if min(limits) > STIFFNESS_MARGIN_OFF * stiffness_npm:
        why = f"off: auto: {found}, are below the bare loop's limit of {_npmm(min(limits))}"
        light_npm = loop(off, HAND_MODELS[2], 1).max_stiffness_npm()
        if light_npm <= STIFFNESS_MARGIN_OFF * stiffness_npm:
            why += f" (not counted: the light hand one sample later, up to {_npmm(light_npm)})"
        return CouplingChoice(off, why, stiffness_npm)
    loads = stiffness_npm * STIFFNESS_MARGIN_PROXY * np.geomspace(0.01, 1.0, 8)

    def radius(coupling: Coupling) -> float:
        return max(
            float(loop(coupling, hand, more).spectral_radius(loads).max())
            for hand in HAND_MODELS
            for more in (0, 1)
        )

    proxy = _stiffest(radius, 1.0 - DECAY_PER_S * dt_s)
    felt = series(proxy.stiffness_npm, stiffness_npm)
    why = (
        f"proxy: auto: {found}, pass the bare loop's limit of {_npmm(min(limits))} "
        f"with a margin of {STIFFNESS_MARGIN_OFF:g}: "
        f"{proxy.stiffness_npm:g} N/m, {proxy.damping_nspm:g} N s/m, {proxy.mass_kg:g} kg; "
        f"the hand feels {_npmm(felt)}"
    )
    return CouplingChoice(proxy, why, felt, every_hand=radius(proxy) < 1.0)


def _stiffest(radius: Callable[[Coupling], float], maximum: float) -> Coupling:
    """Stiffest proxy coupling with a spectral radius up to `maximum`, softened by GAIN_MARGIN.

    The softer one has to keep within it too: in a slow loop it may ring where the stiffer does not.
    If no coupling qualifies, the one with the smallest radius. Within a stiffness the lightest
    proxy comes first: it passes on the least noise.
    """
    minimum = (np.inf, Coupling(mode="proxy"))
    for stiffness_npm in _STIFFNESSES_NPM[::-1]:
        for mass_kg in _MASSES_KG:
            critical = 2.0 * np.sqrt(stiffness_npm * mass_kg)
            for damping_nspm in _RATIOS * critical:
                proxy = Coupling("proxy", stiffness_npm, damping_nspm, mass_kg)
                found = radius(proxy)
                softer = _rounded(proxy, GAIN_MARGIN)
                if found <= maximum and radius(softer) <= maximum:
                    return softer
                minimum = min(minimum, (found, proxy), key=lambda item: item[0])
    return _rounded(minimum[1], 1.0)


def _rounded(proxy: Coupling, share: float) -> Coupling:
    """A softer coupling of the same damping ratio, in two digits."""
    return replace(
        proxy,
        stiffness_npm=float(f"{share * proxy.stiffness_npm:.2g}"),
        damping_nspm=float(f"{np.sqrt(share) * proxy.damping_nspm:.2g}"),
    )


def series(one_npm: float, other_npm: float) -> float:
    """Stiffness of two springs in series, N/m."""
    return one_npm * other_npm / (one_npm + other_npm)


def _npmm(stiffness_npm: float) -> str:
    return f"{1e-3 * stiffness_npm:.3g} N/mm"
