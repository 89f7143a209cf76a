"""Spikes: what is replaced, what is a motion, and that a fit hardly sees them."""

import dataclasses

import numpy as np
import pytest
from support.small import DT_S, press, recording, soft_force

import springpot
from springpot import Recording, check_recordings
from springpot.host.metrics import accuracy
from springpot.host.validation.seen import count_training_recordings
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.quality.spikes import replace_spikes

CYCLES = 0.006 + press(1.0, 0.004, 3)
PRESSES = recording("a", press(1.0, 0.01, 3))
PEAK_N = float(PRESSES.force_n.max())
ROWS = np.arange(5, 2995)


def preloaded(hz: float) -> Recording:
    position_m = 0.006 + press(hz, 0.004, 3)
    return Recording(f"{hz}", position_m, 1.0 + soft_force(position_m), DT_S)


def spoiled(item: Recording, rows: list[int], to_m: float) -> Recording:
    position_m = item.position_m.copy()
    position_m[rows] = to_m
    return dataclasses.replace(item, position_m=position_m)


@pytest.mark.parametrize(
    "rows", [[0], [0, 1, 2], [700], [700, 701, 702, 703, 704], [2999], [5, 700, 702, 1900]]
)
@pytest.mark.parametrize("to_m", [0.0, 0.03, -5.0])
def test_a_spike_of_position_is_replaced_and_counted(rows: list[int], to_m: float) -> None:
    item = preloaded(1.0)
    held, (finding,) = replace_spikes(spoiled(item, rows, to_m))
    assert f"{len(rows)} of 3000 samples of position" in finding.what
    np.testing.assert_allclose(held.position_m, item.position_m, atol=6e-5)
    assert held.force_n is item.force_n
    assert replace_spikes(held) == (held, [finding])  # it is judged once


@pytest.mark.parametrize("share", [0.001, 0.003, 0.01, 0.02, 0.05])
@pytest.mark.parametrize("spike", ["+14", "-14", "half", "stuck", "zero"])
def test_spikes_of_force_up_to_a_twentieth_of_the_samples_are_counted(
    spike: str, share: float
) -> None:
    draw = np.random.default_rng(3)
    clean_n = PRESSES.force_n + draw.normal(0.0, 0.002 * PEAK_N, 3000)
    rows = np.sort(draw.choice(ROWS, round(share * 3000), replace=False))
    force_n = clean_n.copy()
    force_n[rows] = {
        "+14": clean_n[rows] + 14.0, "-14": clean_n[rows] - 14.0, "stuck": 0.7 * PEAK_N,
        "half": clean_n[rows] + 0.5 * PEAK_N * draw.choice([-1, 1], len(rows)), "zero": 0.0,
    }[spike]  # fmt: skip
    seen = np.count_nonzero(np.abs(force_n - clean_n) > 0.02 * PEAK_N)
    held, (finding,) = replace_spikes(dataclasses.replace(PRESSES, force_n=force_n))
    assert finding.severity == "warning"
    assert int(finding.what.split()[0]) == pytest.approx(seen, abs=0.1 * seen + 2)
    left = np.abs(held.force_n - clean_n) > 0.1 * PEAK_N
    assert np.count_nonzero(left) <= 0.1 * len(rows)


def test_what_is_replaced_lies_on_the_sensors_grid() -> None:
    force_n = 0.37 + 0.1 * np.round(10.0 * PRESSES.force_n)
    spiked_n = force_n + 14.0 * (np.arange(3000) == 700)
    held, _ = replace_spikes(dataclasses.replace(PRESSES, force_n=spiked_n))
    steps = (held.force_n[700] - 0.37) / 0.1
    assert steps == pytest.approx(round(steps))


@pytest.mark.parametrize(("channel", "far"), [("force_n", 14.0), ("position_m", 0.02)])
def test_more_spikes_are_refused(channel: str, far: float) -> None:
    values = getattr(PRESSES, channel).copy()
    values[5:2995:15] += far
    report = check_recordings([dataclasses.replace(PRESSES, **{channel: values})])
    assert [found.kind for found in report.findings] == ["outlier"] and report.refused


def test_a_row_of_zeros_before_a_preload_turns_no_sign_round() -> None:
    """The logger had not begun: position falls and force rises, which no object does."""
    whole = preloaded(1.0)
    force_n = np.append(0.0, whole.force_n + 10.0)
    for at_m in (0.02, 0.2, 0.07):
        position_m = np.append(0.0, whole.position_m - at_m)
        report = check_recordings(
            [dataclasses.replace(whole, position_m=position_m, force_n=force_n)]
        )
        kinds = [found.kind for found in report.findings]
        assert kinds[0] == "outlier" and "sign" not in kinds
        assert report.signs[0].position_sign == report.signs[0].force_sign == 1


def test_what_a_tool_did_is_no_spike() -> None:
    time_s, rest = np.arange(3000) * DT_S, np.zeros(3000)
    struck = np.maximum(0.0, 0.5 * np.minimum(time_s - 1.0, 0.02)) * (time_s > 1.0)
    impact_n = soft_force(struck) + 60.0 * np.exp(-(((time_s - 1.003) / 0.001) ** 2))
    hit_n = soft_force(struck) + 60.0 * np.isin(np.arange(3000), (1004, 1005))
    sudden = rest + 0.005 * (np.arange(3000) > 2)  # three samples before a sudden press
    tap = rest + 0.005 * ((np.arange(3000) >= 400) & (np.arange(3000) < 406))  # six samples
    stairs = rest + 0.002 * (np.arange(3000) > 700) + 0.002 * (np.arange(3000) > 702)
    motions = (CYCLES, sudden, tap, stairs, press(200.0, 0.01, 200), rest[:2])
    pairs = [(position_m, soft_force(position_m)) for position_m in motions]
    pairs += [
        (struck, impact_n),
        (struck, hit_n),
        (rest + 0.005, 5.0 + 30.0 * np.exp(-time_s / 0.0005)),
    ]
    triangle = 0.01 * np.abs(np.arange(3000) % 20 - 10) / 10  # ten samples a stroke
    pairs += [(triangle, soft_force(triangle)), (triangle, np.round(soft_force(triangle)))]
    for position_m, force_n in pairs:
        item = Recording("x", position_m, force_n, DT_S)
        assert replace_spikes(item) == (item, [])


@pytest.mark.parametrize("seed", range(6))
def test_hum_a_pull_at_the_surface_and_an_end_in_motion_are_no_events(seed: int) -> None:
    draw = np.random.default_rng(seed)
    rate_hz = float(draw.choice([50.0, 100.0, 200.0, 1000.0]))
    time_s = np.arange(round(draw.uniform(5.0, 12.0) * rate_hz)) / rate_hz
    moving_m = 0.005 * np.sin(2.0 * np.pi * draw.uniform(0.3, rate_hz / 40.0) * time_s) ** 2 - 1e-3
    smooth_n = 800.0 * np.maximum(moving_m, 0.0)
    slow_m = np.linspace(0.0, 0.001, len(time_s))
    width, begin = int(draw.integers(10, 60)), int(draw.integers(20, 100))
    hum_n = np.zeros(len(time_s))
    swings = np.cos(2.0 * np.pi * draw.uniform(0.4, 0.5) * np.arange(width))
    hum_n[begin : begin + width] = draw.uniform(0.01, 0.3) * np.hanning(width) * swings
    burst_n = 0.6 * np.interp(
        time_s % 0.5 * rate_hz, np.arange(8), [0, 0.2, 0.6, 1, 1, 0.6, 0.2, 0]
    )
    pull_n = -1.3 * ((moving_m > -2e-4) & (moving_m <= 0.0))
    noise_n = draw.normal(0.0, 0.002, len(time_s))
    for position_m, force_n in (
        (moving_m, smooth_n),
        (moving_m, smooth_n + noise_n),
        (moving_m, smooth_n + noise_n + pull_n),
        (slow_m, 2e3 * slow_m + noise_n + hum_n),
        (slow_m, 2e3 * slow_m + noise_n + burst_n),
    ):
        item = Recording("x", position_m, force_n, 1.0 / rate_hz)
        assert replace_spikes(item) == (item, [])
        assert "wrap" not in [found.kind for found in check_recordings([item]).findings]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_spikes_spoil_no_fit() -> None:
    presses = [preloaded(hz) for hz in (0.5, 1.0, 4.0)]
    presses[1] = spoiled(presses[1], [0], 0.03)
    fit = springpot.train(presses, "hammerstein", smooth_s=0.0)
    assert fit.model.trained.max_m == pytest.approx(0.01)
    test = preloaded(2.0)
    found = accuracy([test.force_n], [predict_n(fit.model, test)])
    assert found.rmse_percent_of_peak < 1.3  # with the spike: 4.2
    assert count_training_recordings(fit.model, presses) == 3
