"""The springpot law comes back from samples of itself, with intervals that hold it."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from support.files.recording_files import PressedObject, motion
from support.small import press

from springpot.codegen.model.model import Model
from springpot.trainer.features import gl_weights, highpass
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.springpot import Solid, _metadata, _Table, to_hammerstein
from springpot.trainer.models.training_set import build_training_set
from springpot.trainer.recordings.recording import Recording

DT_S = 1e-3
# Published for Ecoflex 00-30: G (1 + (T s)^order) with 23 kPa, 330 us, 0.32; under a flat tip.
STIFFNESS_NPM, ECOFLEX_S, ECOFLEX_ORDER = 610.0, 330e-6, 0.32


def springpot_recordings(
    stiffness_npm: float, coefficient: float, order: float
) -> tuple[Recording, ...]:
    """Presses of a law whose derivative is a Grünwald-Letnikov sum over the whole past."""
    recordings = []
    for share in (0.3, 1.0):
        for frequency_hz in (0.2, 0.5, 1.0, 2.0, 5.0):
            x = press(frequency_hz, share * 0.01)
            weights = gl_weights(order, len(x)) * DT_S**-order
            derivative = np.convolve(x, weights)[: len(x)]
            force_n = stiffness_npm * x + coefficient * derivative
            recordings.append(Recording(f"{share}-{frequency_hz}", x, force_n, DT_S))
    return tuple(recordings)


def fitted(stiffness_npm: float, coefficient: float, order: float) -> Model:
    recordings = springpot_recordings(stiffness_npm, coefficient, order)
    return fit_model("springpot", "x", recordings, FitOptions()).model


def law_of(model: Model) -> dict[str, float]:
    """The numbers of a law."""
    return {name: value for name, (value, _) in model.provenance["material"].items()}


def relaxation_s(law: dict[str, float]) -> float:
    """Relaxation time of a Zener solid."""
    weight_npm = law["instant_npm"] - law["stiffness_npm"]
    return (law["coefficient"] / weight_npm) ** (1.0 / law["order"])


@pytest.mark.parametrize("order", [0.1, 0.3, 0.6, 0.75, 0.95])
def test_the_order_of_an_exact_springpot_comes_back(order: float) -> None:
    law = law_of(fitted(1.0, 1.0, order))
    assert law["order"] == pytest.approx(order, abs=0.01)
    assert law["stiffness_npm"] == pytest.approx(1.0, abs=0.03)
    assert law["coefficient"] == pytest.approx(1.0, abs=0.03)


def let_go(stiffness_npm: float, coefficient: float, order: float) -> Recording:
    """Ramps and holds at three speeds on a surface that stays dented while the tool leaves it.

    At each sample either the surface is at the tool, or nothing pushes it.
    """
    dt_s, knots = 0.02, [(0.0, 0.0)]
    for speed_mps in (1e-4, 1e-3, 5e-3):
        rise_s = 1e-3 / speed_mps
        for more_s, depth_m in ((rise_s, 1e-3), (8.0, 1e-3), (rise_s, 0.0), (12.0, 0.0)):
            knots.append((knots[-1][0] + more_s, depth_m))
    x = np.interp(np.arange(0.0, knots[-1][0], dt_s), *zip(*knots, strict=True))
    weights = coefficient * gl_weights(order, len(x)) * dt_s**-order
    surface_m, force_n = np.zeros(len(x)), np.zeros(len(x))
    for i in range(len(x)):
        past_n = float(weights[1 : i + 1] @ surface_m[:i][::-1])
        pushes_n = (stiffness_npm + weights[0]) * x[i] + past_n
        force_n[i] = max(pushes_n, 0.0)
        surface_m[i] = x[i] if pushes_n > 0.0 else -past_n / (stiffness_npm + weights[0])
    noise_n = np.random.default_rng(1).normal(0.0, 0.005, len(x))
    return Recording("let-go", x, force_n + noise_n, dt_s)


@pytest.mark.parametrize("order", [0.15, pytest.param(0.3, marks=pytest.mark.slow)])
def test_an_object_that_lets_the_tool_go_has_the_law_of_where_it_pushes(order: float) -> None:
    one = let_go(2000.0, 800.0, order)
    session = tuple(replace(one, session="two", start_s=start_s) for start_s in (0.0, 1e5))
    for recordings in ((one,), session):
        law = law_of(fit_model("springpot", "let-go", recordings, FitOptions()).model)
        assert law["stiffness_npm"] == pytest.approx(2000.0, rel=0.01)
        assert law["coefficient"] == pytest.approx(800.0, rel=0.02)
        assert law["order"] == pytest.approx(order, abs=0.01)


def test_the_published_ecoflex_comes_back() -> None:
    coefficient = STIFFNESS_NPM * ECOFLEX_S**ECOFLEX_ORDER
    law = law_of(fitted(STIFFNESS_NPM, coefficient, ECOFLEX_ORDER))
    assert law["stiffness_npm"] == pytest.approx(STIFFNESS_NPM, rel=0.01)
    assert law["order"] == pytest.approx(ECOFLEX_ORDER, abs=0.01)
    assert relaxation_s({"instant_npm": 2.0 * law["stiffness_npm"], **law}) == pytest.approx(
        ECOFLEX_S, rel=0.05
    )


def zener_recordings(order: float, time_s: float) -> tuple[Recording, ...]:
    """Presses of 100 N/m at rest and 300 N/m at once, by a sum of many Maxwell branches."""
    tau_s = np.geomspace(1e-5, 1e5, 400)
    far = order * np.log(tau_s / time_s)
    spectrum = np.sin(np.pi * order) / (2 * np.pi * (np.cosh(far) + np.cos(np.pi * order)))
    weights = 200.0 * spectrum * np.log(tau_s[1] / tau_s[0])
    recordings = []
    for frequency_hz in (0.1, 0.3, 1.0, 3.0, 10.0):
        x = press(frequency_hz, 0.01)
        shares = np.stack([highpass(x, tau, DT_S) for tau in tau_s.tolist()], axis=1)
        recordings.append(Recording(f"{frequency_hz}", x, 100.0 * x + shares @ weights, DT_S))
    return tuple(recordings)


def test_a_zener_solid_comes_back_with_its_instant_stiffness() -> None:
    recordings = zener_recordings(0.5, 0.2)
    law = law_of(fit_model("springpot", "x", recordings, FitOptions(smooth_s=0.0)).model)
    assert law["order"] == pytest.approx(0.5, abs=0.015)
    assert relaxation_s(law) == pytest.approx(0.2, rel=0.05)
    assert law["stiffness_npm"] == pytest.approx(100.0, rel=0.02)
    assert law["instant_npm"] == pytest.approx(300.0, rel=0.02)
    moved = [replace(each, force_n=each.force_n + 0.5, zero="min") for each in recordings]
    model = fit_model("springpot", "x", moved, FitOptions(smooth_s=0.0)).model
    assert np.abs(predict_n(model, moved[2]) - moved[2].force_n).max() < 0.05


@pytest.mark.parametrize(("times", "numbers"), [(0.97, 3), (0.93, 4)])
def test_a_fourth_number_has_to_be_worth_it(
    times: float, numbers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = "springpot.trainer.models.springpot._jackknife"  # of what is held out: fits, error
    monkeypatch.setattr(target, lambda _, its: ([its] * 3, times if its.time_s else 1.0))
    assert len(law_of(fitted(1.0, 1.0, 0.3))) == numbers


@pytest.mark.slow
@pytest.mark.parametrize("is_zener", [False, True])
def test_intervals_hold_what_is_found_without_noise(is_zener: bool) -> None:
    """95 % intervals of noisy presses hold most of the numbers, and are short."""
    whole = zener_recordings(0.5, 0.2) if is_zener else springpot_recordings(1000.0, 400.0, 0.3)
    options = FitOptions(smooth_s=0.0)
    exact = law_of(fit_model("springpot", "x", whole, options).model)
    inside = []
    for seed in range(4):
        noise = np.random.default_rng(seed)
        noisy = tuple(
            dataclasses.replace(r, force_n=r.force_n + noise.normal(0, 0.05, len(r.force_n)))
            for r in whole
        )
        model = fit_model("springpot", "x", noisy, options).model
        for name, (found, half) in model.provenance["material"].items():
            assert 0.0 < half < 0.1 * found
            inside.append(abs(found - exact[name]) <= half)
    assert np.mean(inside) >= 0.9 and 0.0 < model.provenance["residual_percent"] < 10.0


def test_a_law_that_is_not_the_objects_has_no_intervals() -> None:
    """Two Maxwell branches are no fractional solid."""
    solid, noise = PressedObject(5e-3, 8.0, power=1.0), np.random.default_rng(1)
    presses = []
    for seconds in (4.0, 8.0, 16.0):
        x = motion("cycles", 5e-3, 200.0, seconds)
        force_n = solid.force(x, 5e-3) + noise.normal(0.0, 0.01, len(x))
        presses.append(Recording(f"{seconds:g}", x, force_n, 5e-3))
    law = fit_model("springpot", "x", presses, FitOptions()).metadata["material"]
    assert {width for _, width in law.values()} == {None}


def test_an_order_at_the_end_of_the_search_has_no_interval() -> None:
    rows = np.random.default_rng(1).normal(size=(300, 4))
    table = _Table(np.array([0.1, 1.0]), rows, np.zeros(4), np.arange(300) // 60)
    for order, known in ((0.03, False), (0.2, True), (0.97, False)):
        law = _metadata(Solid(9.0, 5.0, order, None), [Solid(9.1, 5.1, order, None)], table, 1)
        assert all((width is not None) == known for _, width in law["material"].values())


def test_half_an_interval_is_1_96_errors_of_a_mean() -> None:
    """Each recording says one stiffness: there leaving out one in turn is exact."""
    said_npm = np.array([90.0, 95.0, 100.0, 108.0, 112.0])
    others = [Solid(float(npm), 5.0, 0.2, None) for npm in (said_npm.sum() - said_npm) / 4.0]
    rows = np.random.default_rng(1).normal(size=(300, 4))
    table = _Table(np.array([0.1, 1.0]), rows, np.zeros(4), np.arange(300) // 60)
    law = _metadata(Solid(101.0, 5.0, 0.2, None), others, table, 1)["material"]
    error_npm = said_npm.std(ddof=1) / np.sqrt(5.0)
    assert law["stiffness_npm"] == pytest.approx([101.0, 1.96 * error_npm], rel=1e-3)


def test_the_same_law_as_branches_begins_where_the_recordings_do() -> None:
    """Of an object that the tool never leaves, pressed from 4 to 10 mm."""
    depth_m = 4e-3 + press(1.0, 6e-3)
    data = build_training_set([Recording("a", depth_m, 300.0 * depth_m, DT_S)], 0.0)
    assert data.trained.min_m == pytest.approx(4e-3)
    tau_s = np.geomspace(1e-3, 10.0, 20)
    law = to_hammerstein(Solid(100.0, 50.0, 0.2, None), tau_s, data)
    assert law.span_m == pytest.approx(6e-3) and law.origin_m == pytest.approx(4e-3)
    assert law.elastic_n[0] / law.span_m == pytest.approx(
        Solid(100.0, 50.0, 0.2, None).weights(tau_s)[0]
    )
