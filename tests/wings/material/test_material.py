"""The springpot law comes back from samples of itself, and its tables are the law's."""

import csv
import dataclasses
import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from support.small import model_file, press, small_model

from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import write_model
from springpot.host.wings.material.commands.material import material
from springpot.host.wings.material.law.geometry import Geometry
from springpot.host.wings.material.law.material import Law, law_of, prony_of
from springpot.host.wings.material.result import material_result
from springpot.trainer.features.fractional import gl_weights
from springpot.trainer.features.values import highpass
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.recording import Recording

DT_S = 1e-3
# Published for Ecoflex 00-30: G (1 + (T s)^order) with 23 kPa, 330 us, 0.32.
ECOFLEX_PA, ECOFLEX_S, ECOFLEX_ORDER = 23e3, 330e-6, 0.32
TIP = Geometry("flat", tip_mm=6.0, height_mm=35.0)


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


@cache
def ecoflex() -> Model:
    stiffness_npm = ECOFLEX_PA / TIP.shear_pa_per_npm
    return fitted(stiffness_npm, stiffness_npm * ECOFLEX_S**ECOFLEX_ORDER, ECOFLEX_ORDER)


@pytest.mark.parametrize("order", [0.1, 0.3, 0.6, 0.75, 0.95])
def test_the_order_of_an_exact_springpot_comes_back(order: float) -> None:
    law = law_of(fitted(1.0, 1.0, order))
    assert law.order == pytest.approx(order, abs=0.01)
    assert law.stiffness_npm == pytest.approx(1.0, abs=0.03)
    assert law.coefficient == pytest.approx(1.0, abs=0.03)


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
    found = fit_model("springpot", "let-go", (let_go(2000.0, 800.0, order),), FitOptions())
    law = law_of(found.model)
    assert law.stiffness_npm == pytest.approx(2000.0, rel=0.01)
    assert law.coefficient == pytest.approx(800.0, rel=0.02)
    assert law.order == pytest.approx(order, abs=0.01)


def test_the_published_ecoflex_comes_back() -> None:
    law = law_of(ecoflex())
    modulus_pa = TIP.shear_pa_per_npm * law.stiffness_npm
    assert modulus_pa == pytest.approx(ECOFLEX_PA, rel=0.01)
    assert law.order == pytest.approx(ECOFLEX_ORDER, abs=0.01)
    assert law.time_s == pytest.approx(ECOFLEX_S, rel=0.05)
    factors = material_result(law, prony_of(ecoflex()), None)["loss_factor"]
    published = {"0.2": 0.04, "1": 0.06, "5": 0.09}
    assert {hz: factors[hz] for hz in published} == pytest.approx(published, abs=0.01)


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
    assert law.order == pytest.approx(0.5, abs=0.015)
    assert law.time_s == pytest.approx(0.2, rel=0.05)
    assert law.stiffness_npm == pytest.approx(100.0, rel=0.02)
    assert law.instant_npm == pytest.approx(300.0, rel=0.02)
    assert not law.not_identified
    # The force of a step falls from the one to the other.
    relaxing_npm = law.relaxing_npm(np.geomspace(1e-6, 1e6, 50))
    assert np.all(np.diff(relaxing_npm) < 0.0)
    assert relaxing_npm[[0, -1]] == pytest.approx([300.0, 100.0], rel=0.03)


def test_a_preloaded_solid_has_a_bias_and_the_order_of_its_loops() -> None:
    recordings = [
        dataclasses.replace(r, force_n=r.force_n + 3.0, zero="min")
        for r in springpot_recordings(300.0, 100.0, 0.3)
    ]
    fit = fit_model("springpot", "x", recordings, FitOptions())
    law = law_of(fit.model)
    assert law.order == pytest.approx(0.3, abs=0.02)
    assert fit.model.hammerstein.bias_n == pytest.approx(3.0, abs=0.01)
    predicted_n = predict_n(fit.model, recordings[0])
    assert np.abs(predicted_n - recordings[0].force_n).max() < 0.02


def test_one_speed_identifies_no_order(tmp_path: Path) -> None:
    """A stiffening object, pressed at one speed: the fit is a number, and says nothing."""
    x = np.abs((np.arange(4000) / 1000.0 + 1.0) % 2.0 - 1.0) * 0.01
    recording = Recording("ramps", x, 2e6 * x**2, DT_S)
    model = fit_model("springpot", "x", [recording], FitOptions()).model
    law = law_of(model)
    assert set(law.not_identified) == {"stiffness_npm", "coefficient", "order"}
    assert "one speed of pressing only: press at three speeds" in law.not_identified["order"]
    assert all(width is None for width in law.intervals.values())
    write_model(tmp_path / "m.spm", model)
    given = [str(tmp_path / "m.spm"), "--tip-mm", "6", "--prony-error", "99%"]
    plain = CliRunner().invoke(material, [*given, "--json"])
    assert "shear_modulus_pa" not in json.loads(plain.stdout)
    out = ["--out", str(tmp_path / "out")]
    refused = CliRunner().invoke(material, [*given, *out])
    assert "--accept-unidentified" in str(refused.exception)
    assert not (tmp_path / "out").exists()
    accepted = CliRunner().invoke(material, [*given, *out, "--accept-unidentified"])
    assert "kPa (not identified" in accepted.stdout
    assert (tmp_path / "out" / "moduli.svg").exists()


def test_real_recordings_at_a_preload(mach1_file: Path) -> None:
    """No order is quoted that the frequencies do not show; the loss is that of the loops."""
    file = mach1_file
    recordings = import_file(file, None, "min", None).recordings
    law = law_of(fit_model("springpot", "x", recordings, FitOptions()).model)
    assert "relaxation time" in law.not_identified["order"]
    assert law.residual_percent < 1.6
    assert len(law.measured) == 5
    for point in law.measured:
        at = law.dynamic_npm(np.array([point["frequency_hz"]]))[0]
        measured = point["loss_npm"] / point["storage_npm"]
        assert at.imag / at.real == pytest.approx(measured, rel=0.15)
        assert at.real == pytest.approx(point["storage_npm"], rel=0.02)


def test_a_prony_series_that_misses_the_law_is_refused(tmp_path: Path) -> None:
    model = ecoflex()
    shifted = dataclasses.replace(model.hammerstein, tau_s=1.5 * model.hammerstein.tau_s)
    write_model(tmp_path / "m.spm", dataclasses.replace(model, hammerstein=shifted))
    refused = CliRunner().invoke(material, [str(tmp_path / "m.spm"), "--prony-error", "1%"])
    assert isinstance(refused.exception, DataError)
    assert "misses the law by" in str(refused.exception)
    assert not CliRunner().invoke(material, [str(tmp_path / "m.spm")]).exception


def test_each_shape_gives_the_modulus_of_its_published_force() -> None:
    """Slopes of F(x) for G = 1 Pa, E = 3 G: Hertz, Sneddon, a bar under uniform stress."""
    g, radius, angle, x, step = 1.0, 4e-3, np.radians(50.0), 1.3e-3, 1e-7
    forces = {
        Geometry("sphere", tip_mm=8.0, depth_mm=1.3): lambda d: (
            16 / 3 * g * np.sqrt(radius) * d**1.5
        ),
        Geometry("cone", depth_mm=1.3, cone_deg=50.0): lambda d: (
            8 / np.pi * g * np.tan(angle) * d**2
        ),
        Geometry("plates", tip_mm=8.0, height_mm=5.0): lambda d: (
            3 * g * np.pi * radius**2 * d / 5e-3
        ),
    }
    for geometry, force_n in forces.items():
        slope_npm = (force_n(x + step) - force_n(x - step)) / (2 * step)
        assert geometry.shear_pa_per_npm * slope_npm == pytest.approx(g, rel=1e-6), geometry
    flat = Geometry("bonded-plates", tip_mm=20.0, height_mm=5.0)  # S = 1: three times as stiff
    sliding = Geometry("plates", tip_mm=20.0, height_mm=5.0)
    assert flat.shear_pa_per_npm == pytest.approx(sliding.shear_pa_per_npm / 3)


@pytest.mark.parametrize(
    ("geometry", "told"),
    [
        (Geometry("flat", tip_mm=-6.0), "--tip-mm -6: give a size above 0"),
        (Geometry("flat", height_mm=6.0), "give --tip-mm as well"),
        (Geometry("flat", 6.0, 0.035), "more than 20 times as wide.*both are in mm"),
        (Geometry("sphere", tip_mm=6.0), "give --depth-mm as well"),
        (Geometry("sphere", tip_mm=6.0, depth_mm=4.0), "deeper than the sphere's radius, 3 mm"),
        (Geometry("sphere", 6.0, 35.0, 1.0), "--height-mm: --geometry sphere has no such size"),
        (Geometry("cone", depth_mm=1.0, cone_deg=90.0), "below 90"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(geometry: Geometry, told: str) -> None:
    with pytest.raises(UsageError, match=told):
        _ = geometry.shear_pa_per_npm


@pytest.mark.parametrize("sizes", [(0.02, None), (6.0, 0.035), (0.006, None)])
def test_sizes_in_metres_are_refused(sizes: tuple[float, float | None]) -> None:
    with pytest.raises(UsageError, match="mm deep: give mm"):
        Geometry("flat", *sizes).require_plausible(3e-3)
    for geometry in (TIP, Geometry("cone", depth_mm=2.0, cone_deg=45.0)):
        geometry.require_plausible(3e-3)
        assert geometry.words


def test_what_begins_under_load_is_not_identified() -> None:
    """What came before the first sample is felt in it: no interval can hold the truth."""
    whole = springpot_recordings(1000.0, 400.0, 0.3)
    assert not law_of(fit_model("springpot", "x", whole, FitOptions()).model).not_identified
    for zero_force_n, left in ((0.0, False), (5.0, True)):
        cut = [
            dataclasses.replace(r, zero="first", details={"zero_force_n": zero_force_n})
            for r in whole
        ]  # fmt: skip
        law = law_of(fit_model("springpot", "x", cut, FitOptions()).model)
        assert ("begins under 5 N" in law.not_identified.get("stiffness_npm", "")) == left


def test_the_interval_of_a_modulus_holds_the_truth() -> None:
    """Of laws known exactly, with noise: 95 % intervals hold most of storage and loss."""
    frequency_hz = np.array([0.2, 0.5, 1.0, 2.0, 5.0])
    exact = Law(1000.0, 400.0, 0.3, {}).dynamic_npm(frequency_hz)
    inside = []
    for seed in range(4):
        noise = np.random.default_rng(seed)
        noisy = tuple(
            dataclasses.replace(r, force_n=r.force_n + noise.normal(0, 0.05, len(r.force_n)))
            for r in springpot_recordings(1000.0, 400.0, 0.3)
        )
        law = law_of(fit_model("springpot", "x", noisy, FitOptions()).model)
        widths = law.dynamic_interval_npm(frequency_hz)
        found = law.dynamic_npm(frequency_hz)
        assert np.all(np.concatenate(widths) < 0.03 * np.abs(exact).max())
        inside += [np.abs(found.real - exact.real) <= widths[0] + 1e-3 * exact.real]
        inside += [np.abs(found.imag - exact.imag) <= widths[1] + 1e-3 * exact.real]
    assert np.mean(inside) >= 0.8
    none = dataclasses.replace(law, not_identified={"order": "one speed"})
    assert none.dynamic_interval_npm(frequency_hz) is None


def test_the_command_writes_tables(tmp_path: Path) -> None:
    write_model(tmp_path / "m.spm", ecoflex())
    given = [str(tmp_path / "m.spm"), "--tip-mm", "6", "--height-mm", "35"]
    done = CliRunner().invoke(material, [*given, "--out", str(tmp_path / "out"), "--json"])
    result = json.loads(done.stdout)
    assert result["shear_modulus_pa"] == pytest.approx(ECOFLEX_PA, rel=0.01)
    assert result["unit"] == "pa"
    tables = {}
    for name in ("moduli", "relaxation", "prony"):
        with (tmp_path / "out" / f"{name}.csv").open() as file:
            tables[name] = list(csv.DictReader(file))
    assert float(tables["moduli"][0]["storage_pa"]) == pytest.approx(result["storage"][0])
    beyond = [float(row["extrapolated"]) for row in tables["moduli"]]
    low_hz, high_hz = result["covered_hz"]
    assert beyond == [float(not low_hz <= hz <= high_hz) for hz in result["frequency_hz"]]
    assert 0 < sum(beyond) < len(beyond)
    shares = sum(float(row["shear_share"]) for row in tables["prony"])
    assert 0.0 < shares < 1.0
    relaxing = [float(row["relaxation_pa"]) for row in tables["relaxation"]]
    assert np.all(np.diff(relaxing) < 0.0)
    assert "<svg" in (tmp_path / "out" / "moduli.svg").read_text()
    assert "kPa" in CliRunner().invoke(material, given).stdout


def test_what_has_no_law_is_refused(tmp_path: Path) -> None:
    other = CliRunner().invoke(material, [str(model_file(tmp_path, small_model()))])
    assert "train with --model springpot" in str(other.exception)
