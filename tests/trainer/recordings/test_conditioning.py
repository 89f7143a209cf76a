"""Delays, mass, tare and contact point: taken out when asked, said, and kept in the details."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.conditioning import Conditioning, align_surfaces, condition
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.recording import Recording

TIME_S = np.arange(4000) * 1e-3
PHASE = 2 * np.pi * 3.0 * TIME_S
POSITION_M = 5e-3 * (1 - np.cos(PHASE))


def recording(
    force_n: np.ndarray, position_m: np.ndarray = POSITION_M, **more: object
) -> Recording:
    return Recording("a", position_m, force_n, 1e-3, **more)  # type: ignore[arg-type]


def test_delays_are_metadata_unless_taken_out() -> None:
    late = recording(1000 * 5e-3 * (1 - np.cos(PHASE - 2 * np.pi * 3.0 * 0.0025)))
    noted, told = condition(late, Conditioning(force_delay_s=0.0025))
    assert (noted.force_delay_s, told) == (0.0025, []) and noted.content_hash == late.content_hash
    aligned, told = condition(late, Conditioning(force_delay_s=0.0025, align=True))
    assert aligned.force_delay_s == 0.0 and aligned.details["aligned_s"] == 0.0025
    assert "force shifted by 2.5 ms against position, 3 samples at the end cut" in told[0]
    np.testing.assert_allclose(aligned.force_n, 1000 * aligned.position_m, atol=1e-6)
    both, _ = condition(late, Conditioning(0.001, 0.0035, align=True))
    np.testing.assert_allclose(both.force_n, 1000 * both.position_m, atol=1e-6)
    with pytest.raises(UsageError, match="no delay is stated"):
        condition(late, Conditioning(align=True))
    with pytest.raises(DataError, match="shorter than the delay"):
        condition(late, Conditioning(force_delay_s=9.0, align=True))


def test_the_inertia_of_a_mass_is_removed() -> None:
    acceleration = 5e-3 * (2 * np.pi * 3.0) ** 2 * np.cos(PHASE)
    measured = recording(1000 * POSITION_M + 0.4 * acceleration)
    found, told = condition(measured, Conditioning(mass_kg=0.4))
    np.testing.assert_allclose(found.force_n[50:-50], 1000 * POSITION_M[50:-50], atol=0.02)
    assert np.abs(measured.force_n - 1000 * POSITION_M).max() > 0.6
    assert "inertia of 0.4 kg removed" in told[0]
    assert found.details["mass_beyond_load_cell_kg"] == 0.4


def touched(surface_m: float, tare_n: float) -> Recording:
    depth_m = np.maximum(POSITION_M - surface_m, 0.0)
    return recording(900 * depth_m + tare_n + np.random.default_rng(5).normal(0, 0.01, len(TIME_S)))


@given(st.floats(5e-4, 4e-3), st.floats(-2.0, 2.0), st.floats(-0.03, 0.03))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_the_surface_is_found_within_its_uncertainty(
    surface_m: float, tare_n: float, drift_nps: float
) -> None:
    """However far the load cell drifts: by up to 9 % of the peak while these presses last."""
    still = touched(surface_m, tare_n)
    found = find_contact(replace(still, force_n=still.force_n + drift_nps * TIME_S))
    assert abs(found.position_m - surface_m) < found.uncertainty_m and found.uncertainty_m < 2e-4


def presses(zeros_m: Sequence[float]) -> list[Recording]:
    """Presses of one object, each with its own noise, counted from the zeros of their files."""
    found = []
    for seed, zero_m in enumerate(zeros_m):
        depth_m = np.maximum(POSITION_M - 2e-3, 0.0)
        noise_n = np.random.default_rng(seed).normal(0.0, 0.01, len(TIME_S))
        found.append(recording(900 * depth_m + noise_n, POSITION_M + zero_m))
    return found


AUTO = Conditioning(contact_force="auto")


def test_presses_with_one_zero_keep_it() -> None:
    """The rig has counted from one place: so do the recordings, and that is the surface."""
    raw = presses([5e-3] * 6)
    found = [condition(each, AUTO)[0] for each in raw]
    moved, told = align_surfaces(found, AUTO)
    zeros_m = [
        before.position_m - after.position_m for before, after in zip(raw, moved, strict=True)
    ]
    assert np.ptp(zeros_m) < 1e-12
    keys = "contact_position_m", "contact_uncertainty_m"
    (surface_m, doubt_m), *own = ([each.details[k] for k in keys] for each in (moved[0], *found))
    assert np.mean(zeros_m) == pytest.approx(surface_m, abs=1e-12)
    assert abs(surface_m - 7e-3) <= doubt_m + 1e-6
    ends_m = max(at_m - its_m for at_m, its_m in own), min(at_m + its_m for at_m, its_m in own)
    assert max(abs(end_m - surface_m) for end_m in ends_m) == pytest.approx(doubt_m, abs=1e-12)
    assert told.startswith("one surface for all 6, where their bounds meet: ")


def test_presses_with_zeros_of_their_own_keep_these() -> None:
    conditioned = [condition(each, AUTO)[0] for each in presses([0.0, 1e-3, 5e-4])]
    kept, told = align_surfaces(conditioned, AUTO)
    assert "each recording keeps its own" in told
    for before, after in zip(conditioned, kept, strict=True):
        np.testing.assert_array_equal(before.position_m, after.position_m)


@pytest.mark.parametrize(("surface_m", "tare_n"), [(2e-3, 0.0), (3e-3, 1.5), (1e-3, -0.7)])
def test_the_surface_becomes_position_0(surface_m: float, tare_n: float) -> None:
    found = find_contact(touched(surface_m, tare_n))
    assert found.tare_n == pytest.approx(tare_n, abs=0.01)
    shifted, told = condition(touched(surface_m, tare_n), Conditioning(contact_force="auto"))
    assert shifted.zero == "none"
    assert shifted.details["contact_position_m"] == pytest.approx(surface_m, abs=2e-4)
    assert np.interp(0.0, *np.sort([shifted.position_m, shifted.force_n])) < 0.2
    assert "tare of" in told[0] and "surface at" in told[0]


def test_a_stated_contact_force_and_tare() -> None:
    found, told = condition(touched(2e-3, 1.0), Conditioning(tare=1.0, contact_force=0.9))
    assert found.details["contact_position_m"] == pytest.approx(3e-3, abs=1e-4)
    assert "where force passes 0.9 N" in told[0]
    tared, _ = condition(touched(2e-3, 1.0), Conditioning(tare="auto"))
    assert np.median(tared.force_n[POSITION_M < 1e-3]) == pytest.approx(0.0, abs=0.01)
    np.testing.assert_array_equal(tared.position_m, POSITION_M)
    stated, _ = condition(touched(2e-3, 1.0), Conditioning(tare=0.5))
    assert np.median(stated.force_n[POSITION_M < 1e-3]) == pytest.approx(0.5, abs=0.01)


def test_what_never_leaves_the_object_has_no_surface() -> None:
    with pytest.raises(DataError, match="never leaves the object"):
        condition(recording(900 * POSITION_M + 3.0), Conditioning(contact_force="auto"))
    with pytest.raises(DataError, match="never passes"):
        condition(touched(2e-3, 0.0), Conditioning(contact_force=50.0))
    with pytest.raises(UsageError, match="leave out --zero"):
        condition(recording(POSITION_M, zero="min"), Conditioning(contact_force="auto"))


def test_the_surface_that_is_known_better_counts_by_the_square() -> None:
    bounds_m = {7.00e-3: 30e-6, 7.02e-3: 60e-6}
    found = [
        replace(recording(np.zeros_like(POSITION_M), POSITION_M),
                details={"contact_position_m": at_m, "contact_uncertainty_m": bound_m})
        for at_m, bound_m in bounds_m.items()
    ]  # fmt: skip
    moved, _ = align_surfaces(found, AUTO)
    surface_m = moved[0].details["contact_position_m"]
    assert surface_m == pytest.approx((4 * 7.00e-3 + 7.02e-3) / 5, abs=1e-9)
