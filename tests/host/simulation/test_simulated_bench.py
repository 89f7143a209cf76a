import runpy

import numpy as np
import pytest
from support.paths import BENCH
from truth import ObjectMotion, SimulatedHand

from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.errors import DeviceError
from springpot.host.devices.virtual import parse_url
from springpot.host.recording import protocols
from springpot.host.simulation.bench import SimulatedBench, bench_library
from springpot.host.simulation.objects import (
    ALL_OBJECTS,
    FOREIGN_OBJECTS,
    HAND_NAMES,
    OBJECTS,
    VARIANTS,
    SimulatedObject,
)

calibration = runpy.run_path(str(BENCH / "calibrate_sim.py"))
SILICONES = [SimulatedObject(name, variant) for name in OBJECTS for variant in VARIANTS]
ALL = SILICONES + [SimulatedObject(name) for name in FOREIGN_OBJECTS]
each_object = pytest.mark.parametrize("simulated", ALL, ids=lambda s: f"{s.name}-{s.variant}")


def energy_j(position_m, force_n):
    """Work done on the object up to each sample, trapezoids."""
    means_n = (force_n[1:] + force_n[:-1]) / 2
    return np.concatenate([[0], np.cumsum(means_n * np.diff(position_m))])


@pytest.mark.parametrize(("kind", "names"), [("object", ALL_OBJECTS), ("hand", HAND_NAMES)])
def test_the_c_has_the_same_names(kind, names):
    c, text = bench_library().c, bench_library().ffi.string
    count = getattr(c, f"sim_{kind}_count")()
    assert tuple(text(getattr(c, f"sim_{kind}_name")(i)).decode() for i in range(count)) == names


@pytest.mark.few(1)
@pytest.mark.parametrize("simulated", SILICONES, ids=lambda s: f"{s.name}-{s.variant}")
def test_depth_and_loss_are_the_calibrated_ones(simulated):
    depth_m, loss = calibration["figures"](f"sim://{simulated.name}?variant={simulated.variant}")
    expected_m, expected_loss = calibration["TARGETS"][simulated.name]
    assert depth_m == pytest.approx(expected_m, rel=0.01)
    assert loss == pytest.approx(expected_loss, abs=0.005)


@pytest.mark.few(1)
@each_object
def test_no_closed_press_gives_energy(simulated):
    """Random journeys that begin and end at the surface: the net work is never the object's."""
    draw = np.random.default_rng(7)
    for _ in range(10):
        knots = draw.integers(4, 12)
        depths_m = np.concatenate([[0], draw.uniform(-0.003, 0.02, knots), [0]])
        times_s = np.concatenate([[0], np.cumsum(draw.choice([0.004, 0.03, 0.2, 1.5], knots + 1))])
        position_m = np.interp(np.arange(0, times_s[-1], 1 / 16000), times_s, depths_m)
        force_n = ObjectMotion(simulated, dt_s=1 / 16000, substeps=1).move(position_m)
        work_j = energy_j(position_m, force_n)
        assert force_n.min() >= 0 and np.all(force_n[position_m <= 0] == 0)
        # On the way too it gives no more than it took, but for the trapezoids' own error.
        assert work_j.min() > -1e-4 * work_j.max() and work_j[-1] > 0.01 * work_j.max()


def test_a_small_fast_cycle_on_a_recovering_surface_gives_no_energy():
    """Leave faster than the surface recovers, and come back while it does."""
    t_s = np.arange(0, 3, 1 / 16000)
    taps_m = 0.004 * np.abs(np.sin(2 * np.pi * 9 * t_s))
    position_m = np.where(t_s < 1, 0.015 * np.sin(np.pi * t_s / 2), taps_m)
    position_m = np.append(position_m, 0.0)
    for simulated in SILICONES:  # others keep energy in a dent, and may return it
        force_n = ObjectMotion(simulated, dt_s=1 / 16000, substeps=1).move(position_m)
        work_j = energy_j(position_m, force_n)
        after_j = work_j[t_s.searchsorted(1.06) :]
        assert after_j[-1] >= after_j[0]


def test_noise_is_what_its_seed_says():
    command_n, url = protocols.training()[4].command_n, "sim://ecoflex-00-50?seed={}"

    def press(seed):
        return SimulatedBench(parse_url(url.format(seed))).press(command_n)

    one, same, other = press(1), press(1), press(2)
    assert np.array_equal(one, same) and not np.array_equal(one[0], other[0])
    assert not np.array_equal(one[1], other[1])
    bench = SimulatedBench(parse_url(url.format(1)))
    assert not np.array_equal(bench.press(command_n)[1], bench.press(command_n)[1])


@pytest.mark.slow
def test_force_control_follows_its_command():
    for simulated in (s for s in ALL if s.name != "stiffening-tissue"):  # has a test of its own
        for profile in protocols.training():
            _, force_n = SimulatedBench(simulated).press(profile.command_n)
            peak_n = profile.command_n.max()
            assert np.sqrt(np.mean((force_n - profile.command_n) ** 2)) < 0.02 + 0.09 * peak_n
            # The maximum of many samples lies about 0.06 N of noise above the truth.
            assert 0.99 * peak_n < force_n.max() < 1.01 * peak_n + 0.14


@pytest.mark.few(1)
@each_object
def test_substeps_converge(simulated):
    """Each refinement by four brings the recorded press closer to the finest one."""
    position_m = 0.007 * (1 - np.cos(2 * np.pi * 5 * np.arange(200) / 1000))
    finest_n = ObjectMotion(simulated, substeps=1024).move(position_m)
    errors = [
        np.abs(ObjectMotion(simulated, substeps=n).move(position_m) - finest_n).max()
        / finest_n.max()
        for n in (4, 16, 64)
    ]
    assert errors[1] < 1e-3 and errors[0] > 2.5 * errors[1] > 6 * errors[2]
    command_n = protocols.training()[22].command_n
    usual, finer = (SimulatedBench(simulated, n).press(command_n) for n in (16, 128))
    assert np.abs(usual[0] - finer[0]).max() < 0.001 * np.ptp(finer[0]) + 30e-6
    assert np.abs(usual[1] - finer[1]).max() < 0.05


def test_a_wall_is_stable_up_to_what_damping_over_delay_allows():
    """A held spring K is stable below b/(1.5 dt) with a sample of delay: 6.6 N/mm at 1 ms."""

    def grows(stiffness_npm, dt_s, delay_samples):
        hand = SimulatedHand("mid", device=LoopDevice(delay_samples=delay_samples))
        position_m, speeds_mps = 0.0, []
        for tick in range(round(6 / dt_s)):
            force_n = stiffness_npm * (position_m + 0.005)
            position_m, velocity_mps = hand.step(dt_s, 0.005 if tick else 0.0, force_n)
            speeds_mps.append(abs(velocity_mps))
        quarter = len(speeds_mps) // 4
        return max(speeds_mps[-quarter:]) > max(speeds_mps[quarter : 2 * quarter])

    assert not grows(6400, 0.001, 1) and grows(6900, 0.001, 1)
    assert not grows(19_000, 0.001, 0) and grows(20_800, 0.001, 0)
    assert not grows(25_500, 0.00025, 1) and grows(27_700, 0.00025, 1)


def test_a_hand_presses_with_the_stiffness_of_its_name():
    """Against a spring: the force there is what the hand's own spring gives."""
    for name in HAND_NAMES:
        hand, position_m, force_n = SimulatedHand(name), 0.0, 0.0
        for intended_m in np.interp(np.arange(6000) / 1000, [0, 0.5, 6], [0, 0.03, 0.03]):
            force_n = 500.0 * position_m
            position_m, _ = hand.step(1e-3, intended_m, force_n)
        stiffness_npm = {"mid": 400, "firm": 5000, "light": 50}[name]
        assert force_n == pytest.approx(stiffness_npm * (0.03 - position_m), rel=0.01)


def test_misuse_of_the_c_is_refused():
    with pytest.raises(ValueError, match="status -2"):
        ObjectMotion(SimulatedObject("ecoflex-00-10")).move(np.array([0.001, np.nan]))
    with pytest.raises(ValueError, match="status -2"):
        ObjectMotion(SimulatedObject("ecoflex-00-10"), substeps=0)
    with pytest.raises(DeviceError, match=r"40\.0 N.*12 N"):
        SimulatedBench(ALL[0]).press(np.full(10, 40.0))
