"""Right recordings that look like faults have no finding; late force has one."""

import numpy as np
import pytest
from scipy.signal import lfilter

import springpot
from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.contact_point import find_contact
from springpot.trainer.recordings.recording import Recording

DEPTH_M, PEAK_N = 4e-3, 10.0


def trapezoids(
    dt_s: float, depths: list[float], way_s: float = 0.3, hold_s: float = 0.5
) -> Samples:
    """From 1 mm of air to shares of DEPTH_M, and out again."""
    at_s, corners = 0.0, [(0.0, -1e-3)]
    for depth in depths:
        for span_s, to_m in ((0.5, -1e-3), (way_s, depth * DEPTH_M), (hold_s, depth * DEPTH_M),
                             (way_s, -1e-3)):  # fmt: skip
            at_s += span_s
            corners.append((at_s, to_m))
    return np.interp(np.arange(0.0, at_s + 0.5, dt_s), *np.array(corners).T)


def noise_n(rows: int) -> Samples:
    return 1e-3 * PEAK_N * np.random.default_rng(3).standard_normal(rows)


def dented(position_m: Samples) -> Samples:
    """Force of an object that yields, and stays dented by 0.8 of its depth."""
    dent, force_n = 0.0, np.zeros(len(position_m))
    for row, depth in enumerate(np.maximum(position_m, 0.0) / DEPTH_M):
        dent = max(dent, depth - 0.1 - 0.1 * depth)
        force_n[row] = 5.0 * PEAK_N * max(depth - dent, 0.0)
    return force_n


def relaxing(position_m: Samples, dt_s: float, tau_s: float = 0.1, elastic: float = 0.6) -> Samples:
    """Force of a spring and a Maxwell branch, one-sided."""
    u, decay = np.maximum(position_m, 0.0) / DEPTH_M, np.exp(-dt_s / tau_s)
    branch = lfilter([1.0], [1.0, -decay], np.diff(u, prepend=0.0))
    return np.where(
        u > 0.0, np.maximum(PEAK_N * (elastic * u + (1.0 - elastic) * branch), 0.0), 0.0
    )


def kinds(position_m: Samples, force_n: Samples, dt_s: float) -> set[str]:
    recording = Recording("press", position_m, force_n + noise_n(len(force_n)), dt_s)
    return {finding.kind for finding in springpot.check_recordings(recording).findings}


def test_an_object_that_stays_dented_is_no_cable_that_came_off() -> None:
    position_m = trapezoids(0.01, [1.0, 0.6, 0.8, 0.7, 1.0, 0.6])
    assert not {"gone", "outlier"} & kinds(position_m, dented(position_m), 0.01)
    comes_off = dented(position_m)
    comes_off[500:] = 0.0  # in the air, before the fourth press
    assert "gone" in kinds(position_m, comes_off, 0.01)


def test_one_sample_of_force_at_the_turn_in_a_dent_is_no_spike() -> None:
    position_m = trapezoids(0.02, [1.0, 0.6, 0.825, 0.7, 0.825, 0.6], way_s=0.8, hold_s=0.0)
    force_n = dented(position_m)
    assert "outlier" not in kinds(position_m, force_n, 0.02)
    force_n[5] = PEAK_N  # in the air
    assert "outlier" in kinds(position_m, force_n, 0.02)


def test_fast_tools_meet_and_leave_objects_within_a_sample() -> None:
    """One that relaxed lets go of its force; and a recording may end in a first sample."""
    leaves_m = trapezoids(0.02, [1.0, 0.9, 0.8, 1.0], way_s=0.4, hold_s=0.2)
    force_n = relaxing(leaves_m, 0.02, tau_s=0.3, elastic=0.1)
    assert "gone" not in kinds(leaves_m, force_n, 0.02)
    meets_m = np.append(trapezoids(0.02, [1.0, 0.8, 0.9]), 1e-3 * np.linspace(-1.0, 0.12, 20))
    force_n = PEAK_N * np.tanh(np.maximum(meets_m, 0.0) / (0.1 * DEPTH_M))
    assert "outlier" not in kinds(meets_m, force_n, 0.02)


def test_a_slope_below_what_counts_as_contact_hides_no_surface() -> None:
    """A slope of 0.025 N/mm is less than hum of 0.04 N; one twice as steep is named."""
    position_m = trapezoids(0.004, [1.0, 0.9, 0.8, 1.0], way_s=1.2)
    position_m = np.where(position_m < 0.0, 3.0 * position_m, position_m)
    time_s = 0.004 * np.arange(len(position_m))
    force_n = PEAK_N * (relaxing(position_m, 0.004) / PEAK_N) ** 1.5 + noise_n(len(time_s))
    force_n += 0.04 * np.sin(2.0 * np.pi * 49.3 * time_s)
    sloped_n = force_n + 25.0 * position_m
    contact = find_contact(Recording("press", position_m, sloped_n, 0.004))
    assert abs(contact.position_m) < max(contact.uncertainty_m, 0.05 * DEPTH_M)
    with pytest.raises(DataError, match=r"changes by 0\.0[78]\d N/mm over"):
        find_contact(Recording("press", position_m, force_n + 80.0 * position_m, 0.004))


def test_a_surface_is_no_farther_than_the_air() -> None:
    """A soft layer on a stiff one has a law so steep that its surface could be anywhere."""
    position_m = trapezoids(0.01, [1.0, 0.9, 0.8])
    u = np.maximum(position_m, 0.0) / DEPTH_M
    force_n = PEAK_N * (0.1 * u + 0.9 * np.maximum(u - 0.2, 0.0))
    contact = find_contact(Recording("press", position_m, force_n + noise_n(len(force_n)), 0.01))
    assert contact.uncertainty_m < 1.5e-3  # of 1 mm of air


@pytest.mark.parametrize("late_s", [0.0, 0.04])
def test_a_force_that_ends_outside_of_where_it_began_is_late(late_s: float) -> None:
    """At least by the way between; at most by the time from the surface on."""
    position_m = trapezoids(0.005, [1.0, 0.9, 0.8, 1.0], way_s=0.6, hold_s=0.0)
    time_s = 0.005 * np.arange(len(position_m))
    force_n = np.interp(time_s - late_s, time_s, relaxing(position_m, 0.005))
    recording = Recording("press", position_m, force_n + noise_n(len(force_n)), 0.005)
    report = springpot.check_recordings(recording)
    late = [finding for finding in report.findings if finding.kind == "alignment"]
    assert len(late) == (late_s > 0.0)
    min_s = 1e-3 * float(late[0].what.split()[-4]) if late else 0.0
    max_s = 1e-3 * float(report.sign_words.split()[-3])
    assert 0.1 * late_s <= min_s <= late_s <= max_s < late_s + 0.01
