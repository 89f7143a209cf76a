"""Rows of the paper's page that hold by construction: each written again from the paper's text.

examples/paper.toml names for each row the test that fails where it is no longer so.
"""

import re
from types import SimpleNamespace

import numpy as np
import paper_formulas as text
import paper_results
import pytest
from paper_claims import WORDS
from paper_page import percentiles
from reproduce import averaged
from scipy.special import gamma
from support.paths import ROOT
from support.silicones import paper_presses
from support.small import DT_S, press, small_model, training

import springpot
from springpot.codegen.coupling.gains import build_couple_config
from springpot.codegen.make_plan import make_plan
from springpot.codegen.scene import Coupling, Scene, Smoothing
from springpot.host.ensemble import FEATURE_SCALE, ensemble_data
from springpot.host.native.c_library import COLUMN
from springpot.host.native.scene_library import build_and_load
from springpot.host.study.definition import read_study
from springpot.host.study.session import PressWatch
from springpot.trainer.features import feature_values

ROWS = [claim for claim in WORDS["claim"] if claim.get("verdict") == "by construction"]
GRID = np.arange(1, 11) / 20


def test_every_row_names_a_test_that_is_there() -> None:
    assert len(ROWS) == 27
    for row in ROWS:
        file, name = row["test"].split("::")
        source = (ROOT / "tests" / file).read_text("utf-8")
        assert re.search(rf"^(?:def |TEST\(){name}\b", source, re.M), row["test"]


def test_orders_go_from_position_to_velocity() -> None:
    one = training()[0]
    values, _ = ensemble_data(one, features=[0.0, 1.0], fraction=1.0)
    speed_mps = np.diff(one.position_m, prepend=0.0) / one.dt_s
    np.testing.assert_allclose(values.T, FEATURE_SCALE * np.stack([one.position_m, speed_mps]),
                               rtol=1e-5, atol=1e-5)  # fmt: skip
    for order in (-0.05, 1.05):
        with pytest.raises(springpot.SpringpotError, match="from 0 to 1"):
            ensemble_data(one, features=[order])


def test_an_object_has_one_depth_and_one_force_at_1_khz_and_is_let_go() -> None:
    for one in paper_presses("ecoflex-00-30"):
        assert one.dt_s == 1e-3 and one.position_m.shape == one.force_n.shape
        deepest = int(np.argmax(one.position_m))
        assert one.position_m[0] < 0.02 * one.position_m[deepest] and one.force_n[0] < 0.2
        assert one.force_n[-1] < 0.5 < one.force_n[deepest]


def test_the_filter_is_a_mean_over_25_samples_of_both() -> None:
    pulse = np.zeros(101)
    pulse[50] = 1.0
    kept = averaged(springpot.Recording("pulse", 1e-3 * pulse, pulse, DT_S))
    for channel, peak in ((kept.position_m, 1e-3), (kept.force_n, 1.0)):
        assert np.flatnonzero(channel > 0.0).tolist() == list(range(38, 63))
        np.testing.assert_allclose(channel[38:63], peak / 25)


def test_features_of_all_presses_stand_below_each_other() -> None:
    presses = training()
    values, force_n = ensemble_data(presses, fraction=1.0)
    assert values.shape == (sum(len(one.force_n) for one in presses), 10)
    np.testing.assert_array_equal(force_n, np.concatenate([one.force_n for one in presses]))
    each = [[text.derivative(one.position_m, order) for order in GRID] for one in presses]
    np.testing.assert_allclose(
        values, FEATURE_SCALE * np.concatenate(each, axis=1).T, rtol=1e-4, atol=1e-4
    )


def test_a_hundred_cubic_functions_of_the_distance_to_their_centres() -> None:
    model = springpot.train(training(), "rbf-pv").model
    rbf, depth_m = model.regressor, press(1.0)
    assert rbf.centers.shape == (100, 2)
    values = feature_values(model.features, depth_m, DT_S, np.arange(len(depth_m)))
    z = (np.clip(values, rbf.feature_min, rbf.feature_max) - rbf.mean) / rbf.scale
    distance = np.linalg.norm(z[:, None] - rbf.centers, axis=2)
    force_n = distance**3 @ rbf.weights_n + rbf.tail_n[0] + z @ rbf.tail_n[1:]
    given_n = springpot.predict(model, depth_m)
    np.testing.assert_allclose(given_n, np.maximum(force_n, 0.0), atol=1e-6)


def test_an_error_is_of_the_measured_force_and_10_percent_are_noticed() -> None:
    measured_n = np.array([1.0, 4.0, 8.0])
    predicted_n = dict.fromkeys(paper_results.KINDS, np.array([2.0, 5.0, 7.0]))
    one = SimpleNamespace(measured_n=measured_n, predicted_n=predicted_n)
    found = paper_results.Result.percent_off(one, "rf-fd")
    np.testing.assert_allclose(found, [25.0, 12.5])  # above 2 N
    label, x_n, percent, *_ = percentiles(one)[0]
    assert "10 %" in label and x_n.tolist() == [2.0, 10.0] and percent.tolist() == [10.0, 10.0]


def test_a_feature_reaches_171_samples_back() -> None:
    model = small_model()
    pulse = np.zeros(220)
    pulse[20] = 1e-3  # before the first sample the object has rested at it
    values = feature_values(model.features, pulse, DT_S, np.arange(220))
    assert model.orders == pytest.approx(GRID) and model.dt_s == 1e-3
    assert np.all(values[190] != 0.0) and not values[191:].any()
    taps = np.stack([text.derivative(pulse, order) for order in GRID], axis=1)
    np.testing.assert_allclose(values, taps, rtol=1e-6, atol=1e-12)


def test_the_newest_velocity_has_a_weight_of_0_7() -> None:
    plain, smoothed = (
        springpot.train(training(), "rbf-pv", velocity_weight=weight).model.features
        for weight in (1.0, 0.7)
    )
    rows, depth_m = np.arange(400), press(2.0)[:400]
    raw, averages = (feature_values(each, depth_m, DT_S, rows)[:, 1] for each in (plain, smoothed))
    np.testing.assert_allclose(averages[1:], 0.7 * raw[1:] + 0.3 * averages[:-1], atol=1e-12)


def test_the_force_of_the_tools_position_enters_the_coupling() -> None:
    """Held still, mode `tool` gives the model's own force; `proxy` a spring in series, less."""
    model, hold_m = springpot.train(training(), "hammerstein").model, np.full(3000, 0.006)
    motion_m = np.concatenate([np.linspace(0.0, 0.006, 500), hold_m])
    scenes = (Scene(1, "x", "m", coupling=Coupling(mode)) for mode in ("off", "tool", "proxy"))
    plans = (make_plan(model, scene, accept_unsafe=True) for scene in scenes)
    off, tool, proxy = (build_and_load(plan).new_state().run(motion_m)[0][-1] for plan in plans)
    assert tool == pytest.approx(off, rel=2e-3) and proxy < 0.95 * off


def test_algorithm_1_step_by_step() -> None:
    """Two steps by hand: the proxy begins at the tool, velocity first, then position."""
    tool_m, model_n = np.array([1e-3, 1.2e-3, 1.3e-3]), (2.0, 3.0, 4.0)
    f1 = -1500.0 * (1e-3 - 1e-3) - 20.0 * (0.0 - 0.0)
    v = 1e-3 * (f1 - 2.0) / 0.05
    x = 1e-3 + 1e-3 * v
    f2 = -1500.0 * (x - 1.2e-3) - 20.0 * (v - 0.2)
    v += 1e-3 * (f2 - 3.0) / 0.05
    x += 1e-3 * v
    f3 = -1500.0 * (x - 1.3e-3) - 20.0 * (v - 0.1)
    given = text.coupled_n(tool_m, lambda tick, tool, proxy: model_n[tick])
    np.testing.assert_allclose(given, [f1, f2, f3])


def test_the_output_s_newest_force_has_a_weight_of_0_7() -> None:
    scene = Scene(1, "x", "m", smoothing=Smoothing(0.83e-3))
    assert make_plan(small_model(), scene).smooth_alpha == pytest.approx(0.7, abs=1e-3)
    model_n = np.linspace(0.0, 5.0, 50)
    one = SimpleNamespace(predicted_n={"rf-fd": model_n}, position_m=1e-3 * model_n,
                          shown=slice(0, 50))  # fmt: skip
    felt_n = paper_results.Result.coupled_n.fget(one)[1]
    raw_n = text.coupled_n(one.position_m, lambda tick, tool, proxy: model_n[tick])
    np.testing.assert_allclose(felt_n[1:], 0.7 * raw_n[1:] + 0.3 * felt_n[:-1])
    gains = build_couple_config(Coupling("tool", 1500.0, 20.0, 0.05), 1e-3, np.float64)
    assert gains.stiffness_npm == text.SPRING_NPM


def warnings(position_m: np.ndarray) -> int:
    """Count the paper's warnings of a motion, on an object known to 10 mm and 10 mm/s."""
    study = read_study(ROOT / "examples" / "paper_study.toml")
    assert (study.warn_depth, study.warn_speed) == (1.0, 4.0)
    watch = PressWatch(DT_S, study.warn_depth * 1e-2, study.warn_speed * 1e-2)
    rows = np.zeros((len(position_m), len(COLUMN)))
    rows[:, COLUMN["position_m"]] = position_m
    rows[:, COLUMN["time_s"]] = DT_S * np.arange(len(position_m))
    watch.append(rows)
    return watch.warnings


def test_deep_and_fast_motion_warns() -> None:
    for speed_mps, depth_m, warned in ((0.03, 0.9e-2, 0), (0.05, 0.9e-2, 1), (0.03, 1.1e-2, 1)):
        position_m = np.append(np.arange(0.0, depth_m, speed_mps * DT_S), depth_m)
        assert warnings(position_m) == warned, (speed_mps, depth_m)


def test_speed_is_taken_over_ten_milliseconds() -> None:
    """Faster for 8 ms is not fast over 10 ms; for 12 ms it is, and would not be over 20 ms."""
    for moving, warned in ((8, 0), (12, 1)):
        position_m = np.interp(np.arange(200), [0, 100, 100 + moving, 200],
                               0.048 * DT_S * np.array([0, 0, moving, moving]))  # fmt: skip
        assert warnings(position_m) == warned, moving


def test_rbf_pv_ticks_at_1000_hz() -> None:
    model = springpot.train(training(), "rbf-pv").model
    assert make_plan(model, Scene(1, "x", "m")).dt_s == 1e-3


def test_the_printed_coefficients_are_those_of_the_gamma_function() -> None:
    pulse = np.zeros(171)
    pulse[0] = 1.0
    k = np.arange(170)  # gamma(171) is the last below 1e308
    for order in (0.05, 0.3, 0.5):
        printed = (-1.0) ** k * gamma(order + 1) / gamma(k + 1) / gamma(order - k + 1)
        np.testing.assert_allclose(
            text.derivative(pulse, order)[:170], printed / 1e-3**order, rtol=1e-9
        )
    assert len(np.flatnonzero(text.derivative(np.eye(1, 300)[0], 0.5))) == text.TAPS == 171
