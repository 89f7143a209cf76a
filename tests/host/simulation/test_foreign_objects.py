"""Objects of other physics than the silicones, against solutions that scipy's solvers find."""

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import erf, exp1
from truth import ObjectMotion

from springpot.host.simulation.objects import SimulatedObject

# Fast in, hold, half out, hold, in again, slowly out: times s, depths m; the punch never leaves.
PRESS_S = np.array([0.0, 0.08, 0.5, 0.55, 0.9, 1.2, 2.2])
PRESS_M = np.array([0.0, 0.011, 0.011, 0.009, 0.009, 0.013, 0.0115])


def simulated_n(name, times_s, depths_m):
    """The object's force at each ms, the first sample at 1 ms."""
    ticks_s = np.arange(1, round(times_s[-1] * 1000) + 1) / 1000
    return ticks_s, ObjectMotion(SimulatedObject(name)).move(np.interp(ticks_s, times_s, depths_m))


def solved(rate, times_s, start, ticks_s):
    """States (k, n) at the ticks of y' = rate(t, y), one tight solution a leg of the press."""
    states = []
    for begin_s, end_s in itertools.pairwise(times_s):
        ticks = ticks_s[(ticks_s > begin_s + 1e-9) & (ticks_s <= end_s + 1e-9)]

        def within(t_s, state, begin_s=begin_s, end_s=end_s):  # a knot belongs to two legs
            return rate(np.clip(t_s, begin_s + 1e-9, end_s - 1e-9), state)

        found = solve_ivp(within, (begin_s, end_s), start, method="LSODA", rtol=1e-10, atol=1e-13,
                          max_step=0.01, t_eval=np.append(ticks[:-1], end_s))  # fmt: skip
        assert found.success
        states.append(found.y)
        start = found.y[:, -1]
    return np.concatenate(states, axis=1)


class TwoNetworks:
    """Bergström and Boyce's equations for one direction, as published, in MPa and m."""

    AREA_M2, HEIGHT_M = np.pi / 4 * 0.004**2, 0.035

    def chain(self, stretch):
        return np.sqrt((stretch**2 + 2 / stretch) / 3)

    def stress_mpa(self, stretch):
        """Of network A; network B has 1.6 times it at its own stretch."""
        share = self.chain(stretch) / np.sqrt(8)
        inverse_langevin = share * (3 - share**2) / (1 - share**2)
        return 0.6 / 3 * inverse_langevin / share * (stretch**2 - 1 / stretch)

    def creep_rate(self, stretch, crept):
        stress_mpa = 1.6 * self.stress_mpa(stretch / crept)
        rate_psmpa = 5 / np.sqrt(3) ** 4 / (self.chain(crept) - 1 + 0.01)
        return rate_psmpa * stress_mpa**4 * np.sign(stress_mpa)

    def force_n(self, stretch, crept):
        both_mpa = self.stress_mpa(stretch) + 1.6 * self.stress_mpa(stretch / crept)
        return -both_mpa * 1e6 / stretch * self.AREA_M2


def test_bergstrom_boyce_is_the_solution_of_its_equations():
    law = TwoNetworks()

    def stretch(t_s):
        return 1 - np.interp(t_s, PRESS_S, PRESS_M) / law.HEIGHT_M

    ticks_s, force_n = simulated_n("bergstrom-boyce", PRESS_S, PRESS_M)
    logs = solved(lambda t, y: law.creep_rate(stretch(t), np.exp(y)), PRESS_S, [0.0], ticks_s)
    expected_n = law.force_n(stretch(ticks_s), np.exp(logs[0]))
    assert expected_n.min() > 0 and np.abs(force_n - expected_n).max() < 5e-4 * expected_n.max()


def test_bergstrom_boyce_recovers_without_a_punch():
    """Released at once: the surface goes where both networks balance, then creeps back."""
    law = TwoNetworks()
    motion = ObjectMotion(SimulatedObject("bergstrom-boyce"))
    ticks_s = np.arange(1, 1501) / 1000
    depth_m = np.where(ticks_s <= 0.5, 0.012, 0.0)
    motion.move(depth_m[:1000])

    def free(crept):
        return brentq(lambda stretch: law.force_n(stretch, crept), 0.5, 1.0, xtol=1e-13)

    held = solve_ivp(lambda _t, y: law.creep_rate(1 - 0.012 / law.HEIGHT_M, np.exp(y)), (0, 0.5),
                     [0.0], method="LSODA", rtol=1e-10, atol=1e-13)  # fmt: skip
    alone = solve_ivp(lambda _t, y: [float(law.creep_rate(free(np.exp(y[0])), np.exp(y[0])))],
                      (0, 0.5), held.y[:, -1], method="LSODA", rtol=1e-9, atol=1e-12)  # fmt: skip
    dent_m = law.HEIGHT_M * (1 - free(np.exp(alone.y[0, -1])))
    assert dent_m > 0.004
    probes_m = np.array([dent_m - 0.00005, dent_m + 0.0004])
    above_n, below_n = motion.move(probes_m)
    assert above_n == 0
    crept = np.exp(alone.y[0, -1])
    assert below_n == pytest.approx(law.force_n(1 - probes_m[1] / law.HEIGHT_M, crept), rel=0.03)


def elastic_n(depth_m):
    """Of the tissue: 40 N/m to 2 mm, a hundred times it from 2.6 mm, exponential between."""
    per_m = np.log(100) / 0.0006
    bent_m = np.clip(depth_m - 0.002, 0, 0.0006)
    straight_m = np.minimum(depth_m, 0.002) + 100 * np.maximum(depth_m - 0.0026, 0)
    return 40 * (straight_m + np.expm1(per_m * bent_m) / per_m)


def relaxation(t_s):
    """Fung's reduced relaxation function with a box spectrum, in closed form."""
    return (1 + 0.15 * (exp1(t_s / 8.38) - exp1(t_s / 0.006))) / (1 + 0.15 * np.log(8.38 / 0.006))


def hereditary_n(times_s, depths_m, ticks_s):
    """Fung's integral of relaxation(t - s) dT(s), by its definition."""
    s = np.linspace(0, times_s[-1], 88_001)
    steps_n = np.diff(elastic_n(np.interp(s, times_s, depths_m)))
    middles_s = (s[1:] + s[:-1]) / 2
    past = [middles_s < t_s for t_s in ticks_s]
    return np.array(
        [relaxation(t_s - middles_s[p]) @ steps_n[p] for t_s, p in zip(ticks_s, past, strict=True)]
    )


def test_stiffening_tissue_is_the_integral_over_its_past():
    depths_m = PRESS_M / 0.013 * 0.0045
    ticks_s, force_n = simulated_n("stiffening-tissue", PRESS_S, depths_m)
    expected_n = hereditary_n(PRESS_S, depths_m, ticks_s[19::20])
    assert expected_n.min() > 0
    assert np.abs(force_n[19::20] - expected_n).max() < 1e-3 * expected_n.max()


class Damage:
    """Ogden and Roxburgh's softening of a neo-Hookean column, healed, and two branches."""

    BRANCHES = ((0.2, 0.3), (0.3, 300.0))  # strength, s

    def __init__(self, times_s, depths_m):
        self.times_s, self.depths_m = times_s, depths_m
        self.speeds_mps = np.diff(depths_m) / np.diff(times_s)

    def elastic(self, t_s):
        """Undamaged force and energy."""
        stretch = 1 - np.interp(t_s, self.times_s, self.depths_m) / 0.035
        energy_j = 8.48 * 0.035 / 2 * (stretch**2 + 2 / stretch - 3)
        return 8.48 * (stretch**-2 - stretch), energy_j

    def rate(self, t_s, state):
        elastic_n, energy_j = self.elastic(t_s)
        leg = min(self.times_s.searchsorted(t_s, side="right"), len(self.speeds_mps)) - 1
        power_w = elastic_n * self.speeds_mps[leg]
        loading = energy_j > state[0] - 1e-8 and power_w > 0
        damaging_w = power_w if loading else (energy_j - state[0]) / 60
        relaxing = ((elastic_n - z) / s for z, (_, s) in zip(state[1:], self.BRANCHES, strict=True))
        return [damaging_w, *relaxing]

    def force_n(self, t_s, states):
        elastic_n, energy_j = self.elastic(t_s)
        below_j = np.maximum(states[0] - energy_j, 0)
        force_n = (1 - erf(below_j / 0.01) / 2.104) * elastic_n
        for z, (strength, _) in zip(states[1:], self.BRANCHES, strict=True):
            force_n = force_n + strength * (elastic_n - z)
        return force_n


def test_mullins_is_the_solution_of_its_equations():
    """Three presses, the second after damage, the third deeper; then 10 s at depth."""
    times_s = np.array([0.0, 0.3, 0.6, 0.9, 1.2, 1.6, 2.0, 12.0, 12.4])
    depths_m = np.array([0.0, 8.0, 3.0, 8.0, 3.0, 10.0, 5.0, 5.0, 9.0]) / 1000
    law = Damage(times_s, depths_m)
    ticks_s, force_n = simulated_n("mullins", times_s, depths_m)
    expected_n = law.force_n(ticks_s, solved(law.rate, times_s, [0.0] * 3, ticks_s))
    assert expected_n.min() > 0 and np.abs(force_n - expected_n).max() < 1e-3 * expected_n.max()
    first_n, second_n = (force_n[round(1000 * t) - 1] for t in (0.206, 0.75))
    assert law.elastic(0.206)[0] < law.elastic(0.75)[0] and second_n < 0.75 * first_n


def squeezed_n(strain):
    """Of the sponge's solid."""
    return 8.0 * strain / (1 - strain)


def drained(depth_at, end_s, ticks_s, cells):
    """Force of the layer at ticks: du/dt = k(strain) dF/dz on so many cells, solved tightly."""
    cell_m = 0.020 / cells

    def strains(t_s, moved_m):
        def unbalanced_n(top_m):
            """The skin's force less the first cell's."""
            return 4000 * (depth_at(t_s) - top_m) - squeezed_n((top_m - moved_m[0]) / cell_m)

        top_m = brentq(unbalanced_n, moved_m[0] - cell_m, moved_m[0] + 0.999 * cell_m, xtol=1e-15)
        return -np.diff(np.concatenate([[top_m], moved_m, [0.0]])) / cell_m

    def rate(t_s, moved_m):
        strain = strains(t_s, moved_m)
        permeability = 1e-4 / 8.0 * np.exp(-4.0 * np.maximum(strain[1:] + strain[:-1], 0) / 2)
        return -permeability * np.diff(squeezed_n(strain)) / cell_m

    found = solve_ivp(rate, (0, end_s), np.zeros(cells - 1), method="LSODA", t_eval=ticks_s,
                      rtol=1e-8, atol=1e-11, max_step=0.01, lband=1, uband=1)  # fmt: skip
    assert found.success
    return np.array([squeezed_n(strains(t, u)[0]) for t, u in zip(ticks_s, found.y.T, strict=True)])


def test_poro_viscoelastic_is_the_solution_of_its_equations():
    """On the same cells to a thousandth; on five times as many within the grid's own error."""
    times_s, depths_m = np.array([0.0, 0.5, 1.5, 1.8, 2.5]), np.array([0, 6, 6, 5.5, 8]) / 1000
    ticks_s, force_n = simulated_n("poro-viscoelastic", times_s, depths_m)
    ticks_s, force_n = ticks_s[9::10], force_n[9::10]

    def depth_at(t_s):
        return np.interp(t_s, times_s, depths_m)

    expected_n = drained(depth_at, times_s[-1], ticks_s, 40)
    assert expected_n.min() > 0 and np.abs(force_n - expected_n).max() < 2e-3 * expected_n.max()
    assert np.abs(force_n - drained(depth_at, 2.5, ticks_s, 200)).max() < 0.04 * expected_n.max()
