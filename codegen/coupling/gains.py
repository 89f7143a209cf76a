"""Gains of the virtual coupling: their exact discretisation, and those that are unit errors."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from springpot.codegen.arrays import Real, Reals, Samples
from springpot.codegen.errors import UnsafeError
from springpot.codegen.scene import Coupling

PAPER_DT_S = 1e-3
MAX_DAMPING_RATIO = 10.0  # the paper's is 1.15; with b = 20 N s/mm, as it prints, 1155
# A proxy may be as light as its step is exact, whatever the published step allows; but no device
# does more.
MAX_PROXY_NPM = 1e6
MAX_PROXY_NSPM = 1e3


@dataclass(frozen=True, eq=False)
class CoupleConfig:
    """sp_couple.h; phi: shape (4,), the 2 x 2 matrix row by row."""

    stiffness_npm: Real
    damping_nspm: Real
    compliance_mpn: Real
    dt_s: Real
    phi: Reals


def published_step_is_stable(coupling: Coupling, dt_s: float) -> bool:
    """Stability of the paper's Algorithm 1 (semi-implicit Euler): 2 b dt/m + k dt^2/m < 4.

    For a still tool, z^2 - (2 - b dt/m - k dt^2/m) z + 1 - b dt/m is positive at z = -1 there, the
    only one of Jury's conditions that positive gains can break first.
    """
    k, b, m = coupling.stiffness_npm, coupling.damping_nspm, coupling.mass_kg
    return 2.0 * b * dt_s / m + k * dt_s**2 / m < 4.0


def max_published_damping_nspm(coupling: Coupling, dt_s: float) -> float:
    """Damping up to which Algorithm 1 as published is stable, N s/m; 0 where it never is."""
    k, m = coupling.stiffness_npm, coupling.mass_kg
    return max(0.0, (4.0 * m - k * dt_s**2) / (2.0 * dt_s))


@lru_cache(maxsize=256)
def state_transition(
    stiffness_npm: float, damping_nspm: float, mass_kg: float, dt_s: float
) -> Samples:
    """exp(A dt) for A = [[0, 1], [-k/m, -b/m]], (2, 2), in closed form; shared: only read it.

    With A = a I + N, a = -b/2m, N^2 = (a^2 - k/m) I: exp = e^(a dt) (c I + s N), where c and s are
    cosh and sinh/root where the proxy is overdamped, and cos and sin/root where it swings.
    """
    a = -damping_nspm / (2.0 * mass_kg)
    square = a * a - stiffness_npm / mass_kg
    root = math.sqrt(abs(square))
    if square > 0.0:
        # The slow and the fast exponential apart: cosh alone overflows for large damping, and
        # a + root cancels; (root - a)(-a - root) = k/m gives it without a difference.
        fast = math.exp((a - root) * dt_s)
        slow = math.exp(-(stiffness_npm / mass_kg) / (root - a) * dt_s)
        c, s = (slow + fast) / 2.0, (slow - fast) / (2.0 * root)
    else:
        decay = math.exp(a * dt_s)
        c = decay * math.cos(root * dt_s)
        s = decay * (math.sin(root * dt_s) / root if root > 0.0 else dt_s)
    matrix = np.array([[0.0, 1.0], [-stiffness_npm / mass_kg, -damping_nspm / mass_kg]])
    return c * np.eye(2) + s * (matrix - a * np.eye(2))


def build_couple_config(
    coupling: Coupling, dt_s: float, real: Callable[[float], Real]
) -> CoupleConfig:
    """Constants of sp_couple.h, rounded to the scene's type only after phi is computed."""
    phi = state_transition(coupling.stiffness_npm, coupling.damping_nspm, coupling.mass_kg, dt_s)
    return CoupleConfig(
        stiffness_npm=real(coupling.stiffness_npm),
        damping_nspm=real(coupling.damping_nspm),
        compliance_mpn=real(1.0 / coupling.stiffness_npm),
        dt_s=real(dt_s),
        phi=np.array([real(value) for value in phi.ravel()]),
    )


def require_plausible_damping(coupling: Coupling) -> None:
    """Raise UnsafeError for gains that only a wrong unit explains; name the value that was meant.

    The exact step is stable with any damping, so that a wrong unit no longer oscillates: it glues
    the proxy to the tool. Coupled at the tool, Algorithm 1 as published therefore decides, at the
    paper's 1 ms whatever the scene's rate; at the proxy, what devices do.
    """
    if _is_plausible(coupling):
        return
    stated = (
        f"coupling: stiffness_npm = {coupling.stiffness_npm:g}, damping_nspm = "
        f"{coupling.damping_nspm:g}, mass_kg = {coupling.mass_kg:g} look like a unit error"
    )
    for key, unit in (("damping_nspm", "N s/m"), ("stiffness_npm", "N/m")):
        meant = getattr(coupling, key) / 1e3
        if _is_plausible(replace(coupling, **{key: meant})):
            raise UnsafeError(f"{stated}: {key} = {meant:g} ({meant:g} {unit}) was probably meant")
    raise UnsafeError(f"{stated}: the paper's gains are 1500 N/m, 20 N s/m and 0.05 kg")


def is_implausible(coupling: Coupling) -> bool:
    """Return True if `require_plausible_damping` refuses these gains; never "auto" and "off"."""
    return coupling.mode in ("tool", "proxy") and not _is_plausible(coupling)


def _is_plausible(coupling: Coupling) -> bool:
    """Return False for gains that only a wrong unit explains (`require_plausible_damping`)."""
    k, b, m = coupling.stiffness_npm, coupling.damping_nspm, coupling.mass_kg
    # A proxy may be lighter than the paper's, for its step is exact: that is no wrong unit.
    mass_kg = max(m, Coupling.mass_kg) if coupling.mode == "proxy" else m
    if b / (2.0 * math.sqrt(k * mass_kg)) > MAX_DAMPING_RATIO:
        return False
    if coupling.mode == "proxy":
        return k <= MAX_PROXY_NPM and b <= MAX_PROXY_NSPM
    return published_step_is_stable(coupling, PAPER_DT_S)
