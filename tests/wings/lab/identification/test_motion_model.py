"""The model that is fitted against the simulated device, which integrates on its own."""

import numpy as np

from springpot.host.wings.lab.free_device import FreeDevice, FreeDeviceTruth
from springpot.host.wings.lab.identification.motion_model import ModelLanes, simulate_lanes

TRUTHS = [
    FreeDeviceTruth(delay_s=0.00137, position_step_m=0.0),
    FreeDeviceTruth(0.05, 8.0, 0.5, 0.005, position_step_m=0.0),
    FreeDeviceTruth(1.0, 0.0, 0.0, 0.0, position_step_m=0.0),
    FreeDeviceTruth(0.01, 8.0, 0.1, 0.0005, position_step_m=0.0),
]


def test_both_move_alike() -> None:
    """Free, sticking and without friction, in one call and started again in the midst."""
    chance = np.random.default_rng(0)
    force_n = np.repeat(chance.uniform(-1, 1, 50), 20)
    columns = zip(*[(t.mass_kg, t.viscous_nspm, t.coulomb_n, 0.0, t.delay_s) for t in TRUTHS],
                  strict=True)  # fmt: skip
    model = ModelLanes(*(np.array(column) for column in columns))
    true = []
    for truth in TRUTHS:
        device = FreeDevice(truth, 1e-3)
        motion = [(0.0, 0.0)]
        for pushed_n in force_n[:-1]:
            device.step(-pushed_n)
            motion.append(device.true_motion())
        true.append(motion)
    true_m, true_mps = np.moveaxis(np.array(true), 2, 0)
    for begin in (0, 333):
        positions_m, velocities_mps = simulate_lanes(
            model, force_n, np.full(len(TRUTHS), begin), len(force_n) - begin, 1e-3,
            true_m[:, begin], true_mps[:, begin],
        )  # fmt: skip
        assert np.abs(positions_m - true_m[:, begin:]).max() < 1e-8
        assert np.abs(velocities_mps - true_mps[:, begin:]).max() < 1e-5
    assert np.ptp(true_m, axis=1).min() > 1e-3


def test_bristles_give_way_before_they_slide() -> None:
    device = FreeDevice(FreeDeviceTruth(coulomb_n=0.4, bristle_m=40e-6, static_ratio=1.5), 1e-3)
    for push_n in np.linspace(0.0, 0.2, 1000):
        device.step(-push_n)
    bent_m, _ = device.true_motion()
    assert 18e-6 < bent_m < 30e-6
    for push_n in np.linspace(0.2, 0.5, 1000):
        device.step(-push_n)
    assert device.true_motion()[0] < 200e-6  # 0.6 N hold it at rest
    for push_n in np.linspace(0.5, 0.7, 1000):
        device.step(-push_n)
    assert device.true_motion()[0] > 1e-3
