"""The C that moves a device: no force beyond its limits, whatever it is given."""

from typing import Any

import numpy as np
import pytest
from support.free_device import LIMITS

from springpot.codegen.reference.notes import LATCHED
from springpot.host.wings.lab.identification.excitation import (
    WATCHDOG_S,
    Excitation,
    excite_step_functions,
    pulses,
    sweep,
)


class Excited:
    """The C, called by hand."""

    def __init__(self, excitation: Excitation) -> None:
        self._steps, self.state = excite_step_functions(excitation, LIMITS)
        self._force_n = self._steps.library.ffi.new("double *")

    def step(self, position_m: float) -> tuple[int, float]:
        notes = self._steps.library.c.sp_excite_step(self.state, position_m, np.nan, self._force_n)
        return notes, self._force_n[0]

    def idle(self, dt_s: float) -> tuple[int, float]:
        notes = self._steps.library.c.sp_excite_idle(self.state, dt_s, self._force_n)
        return notes, self._force_n[0]

    def reset(self) -> None:
        self._steps.library.c.sp_excite_reset(self.state)


def constant(sign: int = 0, gain_n: float = 1.0, **also: Any) -> Excitation:
    return Excitation(np.ones(1000), 1e-3, gain_n, sign=sign, **also)


@pytest.mark.parametrize("sign", [-1, 1])
def test_no_force_is_beyond_the_limit(sign: int) -> None:
    excited = Excited(sweep(1000, LIMITS, sign))
    chance = np.random.default_rng(0)
    forces_n = [excited.step(x)[1] for x in chance.uniform(-0.0099, 0.0099, 2000)]
    assert max(np.abs(forces_n)) == LIMITS.max_force_n


@pytest.mark.parametrize("sign", [-1, 0, 1])
@pytest.mark.parametrize("beyond_m", [0.0201, -0.0201, np.nan, np.inf])
def test_beyond_the_travel_it_is_over_either_way(sign: int, beyond_m: float) -> None:
    excited = Excited(constant(sign))
    assert excited.step(0.5) == (0, 1.0)  # where it begins is its middle
    assert excited.step(0.5 + beyond_m) == (LATCHED, 0.0)
    excited.reset()
    assert excited.step(0.5) == (LATCHED, 0.0)
    assert excited.state.beyond


@pytest.mark.parametrize("sign", [-1, 1])
def test_the_spring_pulls_back_and_nothing_pushes_further_out(sign: int) -> None:
    for offset_m in (0.004, -0.004, 0.014, -0.014):
        excited = Excited(Excitation(np.zeros(1000), 1e-3, 0.0, sign=sign))
        excited.step(0.0)
        forces_n = [excited.step(offset_m)[1] for _ in range(200)]
        assert sign * forces_n[-1] * offset_m > 0  # positive pushes out: towards smaller positions
    pushed = Excited(constant(-1, gain_n=2.0))
    pushed.step(0.0)
    assert [pushed.step(0.013)[1] for _ in range(200)][-1] < 0


def test_without_samples_it_is_over() -> None:
    excited = Excited(constant())
    excited.step(0.0)
    assert excited.idle(WATCHDOG_S / 2) == (0, 0.0)
    assert excited.step(0.0) == (0, 1.0)
    assert excited.idle(0.6 * WATCHDOG_S) == (0, 0.0)
    assert excited.idle(0.6 * WATCHDOG_S) == (LATCHED, 0.0)
    assert excited.step(0.0) == (LATCHED, 0.0)


def test_pulses_grow_and_end_soon_after_one_was_seen() -> None:
    excitation = pulses(1000, LIMITS)
    excited = Excited(excitation)
    forces_n = [excited.step(0.0)[1] for _ in range(len(excitation.command))]
    assert not excited.state.seen
    sizes = np.abs(forces_n)[excitation.quiet_ticks :: excitation.pulse_ticks]
    assert (np.diff(sizes) >= 0).all()
    assert sizes[0] < 0.05 * LIMITS.max_force_n
    assert sizes[-1] == sizes[-2] == LIMITS.max_force_n
    assert np.sum(forces_n) == pytest.approx(0.0, abs=1e-9)
    moving = Excited(excitation)
    ticks = excitation.quiet_ticks + 3 * excitation.pulse_ticks + 20
    for _ in range(ticks):
        moving.step(0.0)
    moving.step(3e-4)
    assert moving.state.n == excitation.quiet_ticks + 5 * excitation.pulse_ticks
