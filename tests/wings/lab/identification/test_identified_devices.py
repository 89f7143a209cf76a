"""Devices of which the truth is known, measured in lock step."""

import numpy as np
import pytest
from support.free_device import LIMITS, LockStep, random_truth

from springpot.codegen.errors import DeviceError, SpringpotError
from springpot.host.wings.lab.free_device import FreeDeviceTruth
from springpot.host.wings.lab.identification.estimate import estimate_device
from springpot.host.wings.lab.identification.excitation import MoveLimits, sweep
from springpot.host.wings.lab.identification.experiment import find_sign, identify_device
from springpot.host.wings.lab.identification.free_motion import free_motion
from springpot.host.wings.lab.identification.result import DeviceMeasured

NAMES = ("mass_kg", "viscous_nspm", "coulomb_n", "delay_s", "position_step_m")
WITHIN = 0.1


def measure(device: LockStep, limits: MoveLimits = LIMITS, rate_hz: float = 1000) -> DeviceMeasured:
    """Measure it, and assert that neither force nor travel was ever beyond its limit."""
    found = identify_device(device, limits, rate_hz, "it")
    assert max(np.abs(device.sent_n)) <= limits.max_force_n
    assert max(np.abs(device.true_m)) <= limits.max_travel_m
    return found


def errors_of(found: DeviceMeasured, truth: FreeDeviceTruth) -> dict[str, float]:
    """Relative errors of what was found."""
    values = {name: getattr(found, name) for name in NAMES}
    assert all(item.why for item in values.values() if item.value is None)
    return {
        name: abs(item.value / getattr(truth, name) - 1)
        for name, item in values.items()
        if item.value is not None
    }


def check_one(seed: int, **also: float) -> dict[str, float]:
    truth = random_truth(seed, **also)
    found = measure(LockStep(truth))
    assert found.force_sign.value == truth.sign
    errors = errors_of(found, truth)
    assert all(error <= WITHIN for error in errors.values()), (seed, errors)
    return errors


@pytest.mark.parametrize("seed", range(5))
def test_what_is_found_is_true(seed: int) -> None:
    assert set(check_one(seed)) == set(NAMES)


@pytest.mark.slow
def test_twenty_devices_and_their_intervals() -> None:
    inside, found = 0, 0
    for seed in range(100, 120):
        truth = random_truth(seed)
        device = measure(LockStep(truth))
        assert all(error <= WITHIN for error in errors_of(device, truth).values())
        for name in NAMES[:4]:
            item = getattr(device, name)
            found += item.value is not None
            inside += item.low <= getattr(truth, name) <= item.high
    assert found >= 76  # of 80
    assert inside >= 70  # 95 % of 80 are 76; fewer than 70 are one chance in 500


@pytest.mark.slow
def test_devices_outside_of_the_model() -> None:
    """Bristles that give, more friction at rest, cogging: true, or not told."""
    told = 0
    for seed in range(200, 212):
        chance = np.random.default_rng(seed)
        told += len(
            check_one(
                seed,
                bristle_m=float(np.exp(chance.uniform(np.log(5e-6), np.log(50e-6)))),
                static_ratio=chance.uniform(1.0, 1.5),
                cogging_n=chance.uniform(0.0, 0.03),
                cogging_pitch_m=chance.uniform(0.002, 0.01),
            )
        )
    assert told >= 12 * 3


def test_bristles_and_cogging_widen_the_intervals() -> None:
    plain = FreeDeviceTruth(position_noise_m=3e-6)
    rough = FreeDeviceTruth(position_noise_m=3e-6, bristle_m=3e-5, static_ratio=1.3,
                            cogging_n=0.01, cogging_pitch_m=0.004)  # fmt: skip
    of_plain, of_rough = (measure(LockStep(truth)) for truth in (plain, rough))
    assert of_plain.misfit < 1.2
    assert of_rough.misfit > 2
    assert of_rough.mass_kg.value == pytest.approx(0.2, rel=0.03)
    width = [item.mass_kg.high - item.mass_kg.low for item in (of_plain, of_rough)]
    assert width[1] > 10 * width[0]


def test_friction_hides_in_friction() -> None:
    """A heavy device that a weak force hardly moves: speeds too small for the viscous part."""
    truth = FreeDeviceTruth(mass_kg=1.0, viscous_nspm=0.2, coulomb_n=0.3, bristle_m=5e-5,
                            static_ratio=1.3)  # fmt: skip
    found = measure(LockStep(truth), MoveLimits(0.6, 0.004))
    assert found.viscous_nspm.value is None
    assert "hidden under" in found.viscous_nspm.why
    assert all(error <= WITHIN for error in errors_of(found, truth).values())


@pytest.mark.parametrize("rate_hz", [100, 4000])
def test_other_rates(rate_hz: float) -> None:
    truth = FreeDeviceTruth(delay_s=0.0015, position_noise_m=3e-6)
    found = measure(LockStep(truth, 1 / rate_hz), rate_hz=rate_hz)
    assert all(error <= WITHIN for error in errors_of(found, truth).values())
    assert found.delay_s.value == pytest.approx(0.0015, abs=2e-5)


def test_a_velocity_sensor_and_a_difference_of_positions() -> None:
    for truth, noise_mps in (
        (FreeDeviceTruth(velocity_noise_mps=0.02), 0.02),
        (FreeDeviceTruth(position_noise_m=8e-6), 2**0.5 * np.hypot(8e-6, 1e-5 / 12**0.5) / 1e-3),
    ):
        assert measure(LockStep(truth)).velocity_noise_mps.value == pytest.approx(
            noise_mps, rel=0.1
        )


def test_some_samples_may_be_missing() -> None:
    truth = FreeDeviceTruth(position_noise_m=3e-6)
    errors = errors_of(measure(LockStep(truth, missing=0.03)), truth)
    assert set(errors) == set(NAMES)
    assert max(errors.values()) <= WITHIN


@pytest.mark.parametrize(
    ("truth", "limits", "missing", "error", "says"),
    [
        (FreeDeviceTruth(coulomb_n=3.0), LIMITS, 0.0, DeviceError, "does not move"),
        (FreeDeviceTruth(bias_n=0.5), LIMITS, 0.0, DeviceError, "moves by itself"),
        (FreeDeviceTruth(), MoveLimits(2.0, 3e-4), 0.0, SpringpotError, "the limit is 0.3 mm"),
        (FreeDeviceTruth(), LIMITS, 0.1, DeviceError, "had no sample"),
    ],
)
def test_refusals_say_why_and_what_to_do(
    truth: FreeDeviceTruth, limits: MoveLimits, missing: float, error: type[Exception], says: str
) -> None:
    device = LockStep(truth, missing=missing)
    with pytest.raises(error, match=says) as refused:
        identify_device(device, limits, 1000, "it")
    assert type(refused.value) is error
    assert str(refused.value).startswith("it: ")
    assert device.sent_n[-1] == 0.0
    assert max(np.abs(device.sent_n)) <= limits.max_force_n


@pytest.mark.parametrize("tick", [100, 700, 4000])
def test_a_position_that_is_no_number_ends_it(tick: int, monkeypatch: pytest.MonkeyPatch) -> None:
    device = LockStep(FreeDeviceTruth())
    step = device.device.step
    monkeypatch.setattr(
        device.device,
        "step",
        lambda n: (np.nan, 0.0) if len(device.sent_n) == tick else step(n),
    )
    with pytest.raises(DeviceError, match="a position that is no number"):
        identify_device(device, LIMITS, 1000, "it")
    assert not any(device.sent_n[tick:])


def test_a_sign_that_is_wrong_is_seen_in_the_motion() -> None:
    for seed in range(8):
        truth = random_truth(seed, sign=1.0)
        device = LockStep(truth)
        rows, _ = device(sweep(1000, LIMITS, 1), LIMITS)
        motion = free_motion(rows, -1, 1e-3, "it")
        with pytest.raises(SpringpotError, match="moved against the force"):
            estimate_device(motion, motion, -1, None, "it")


def test_a_sign_is_found_against_gravity_and_friction() -> None:
    for seed in range(30):
        chance = np.random.default_rng(seed)
        coulomb_n = chance.uniform(0.0, 0.5)
        also = {"bristle_m": 2e-5, "static_ratio": 1.3} if seed % 3 == 0 else {}
        truth = random_truth(
            seed, coulomb_n=coulomb_n, bias_n=chance.uniform(-0.9, 0.9) * coulomb_n, **also
        )
        assert find_sign(LockStep(truth), LIMITS, 1000, "it")[1] == truth.sign, truth
