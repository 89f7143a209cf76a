"""What the stability check says of every hand and delay that the page's sliders can ask for."""

from typing import Any

from springpot.codegen.coupling.linear_loop import DESIGN_HAND, Hand
from springpot.codegen.plan.plan import Plan
from springpot.host.stability.linear import is_stable, loop_words, scene_loop

# The hands of the check are among them; the damping is the design hand's.
STIFFNESS_NPM = (100.0, 200.0, 300.0, 400.0, 600.0, 1000.0, 1500.0)
MASS_KG = (0.06, 0.12, 0.25, 0.3, 0.5, 1.0)
MAX_ADDED_DELAY = 3
_UNLIMITED_NPM = 1e7


def hands_entry(plan: Plan) -> dict[str, Any]:
    """Return the page's hands, and verdicts[stiffness][mass][added delay]."""
    device = plan.loop_device
    return {
        "stiffness_npm": STIFFNESS_NPM,
        "mass_kg": MASS_KG,
        "damping_nspm": DESIGN_HAND.damping_nspm,
        "device": [device.mass_kg, device.viscous_nspm, device.coulomb_n],
        "device_words": device.words(plan.dt_s).replace("`", ""),
        "own_delay": device.delay_samples,
        "object_npmm": _npmm(plan.stiffness_npm),
        "verdicts": [
            [
                [hand_verdict(plan, stiffness_npm, mass_kg, more) for more in added_delays()]
                for mass_kg in MASS_KG
            ]
            for stiffness_npm in STIFFNESS_NPM
        ],
    }


def added_delays() -> range:
    """Return samples of delay beyond those of the scene's device."""
    return range(MAX_ADDED_DELAY + 1)


def hand_verdict(
    plan: Plan, stiffness_npm: float, mass_kg: float, more_delay: int
) -> dict[str, Any]:
    """Return whether a loop with that hand is stable, in the check's words, and what it allows."""
    hand = Hand(DESIGN_HAND.name, mass_kg, stiffness_npm, DESIGN_HAND.damping_nspm)
    loop = scene_loop(plan, hand, more_delay)
    radius = float(loop.spectral_radius(plan.stiffness_npm)[0])
    stable, limit_npm = is_stable(plan, loop), loop.max_stiffness_npm()
    limit = "any stiffness" if limit_npm >= _UNLIMITED_NPM else f"{_npmm(limit_npm)} N/mm"
    return {"stable": stable, "words": loop_words(stable, radius), "limit": limit}


def _npmm(stiffness_npm: float) -> str:
    return f"{1e-3 * stiffness_npm:.3g}"
