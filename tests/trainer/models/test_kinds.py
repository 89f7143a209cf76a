"""Every kind of model: through emit and build bit for bit, and on real recordings by others."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.files.mach1 import mach1_recordings
from support.paths import ROOT, TESTS
from support.small import VARIANTS, fitted, press, recording, scene, training

from springpot import Recording, predict, train
from springpot.codegen.arrays import rms
from springpot.codegen.make_plan import make_plan
from springpot.host.metrics import accuracy
from springpot.host.native.scene_library import build_and_load
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.folds import geometric_mean
from springpot.trainer.models.predict import predict_n

KINDS = ["rf-fd", "rbf-fd", "rbf-pv", "hammerstein", "springpot"]


@pytest.mark.few(2)
@pytest.mark.parametrize("variant", VARIANTS)
def test_the_c_predicts_what_the_model_predicts(variant: str) -> None:
    model = fitted(variant)
    item = recording("new", press(1.7, 0.010))
    # What the model gives, whether a hand paid for it or not.
    chosen = scene(number="float64")
    force_n, _ = build_and_load(make_plan(model, chosen)).new_state().run(item.position_m)
    predicted_n = predict_n(model, item)
    inside = item.position_m > 0.002  # below the onset, where contact shapes the force
    # Trees may take the other branch where a feature rounds differently.
    assert rms(force_n[inside] - predicted_n[inside]) < 2e-3 * predicted_n.max()


@pytest.mark.slow
def test_every_kind_beats_a_plain_spring_and_carries_a_passive_part() -> None:
    item = recording("new", press(1.7, 0.011))
    slope = np.concatenate([rec.position_m for rec in training()])
    force_n = np.concatenate([rec.force_n for rec in training()])
    spring_n = item.position_m * (slope @ force_n) / (slope @ slope)
    for kind in KINDS:
        model = fitted(kind)
        assert rms(predict_n(model, item) - item.force_n) < rms(spring_n - item.force_n), kind
        assert model.hammerstein is not None, kind
        assert model.hammerstein_adds == (kind in {"hammerstein", "springpot"})


def test_a_fit_keeps_to_one_thread_of_every_blas() -> None:
    """scipy's is loaded late: with more threads a fit took ten times as long on a busy machine."""
    code = """import springpot.trainer.kinds as kinds, support.small, threadpoolctl
fit, libraries = kinds._fit_entry_point, threadpoolctl.threadpool_info
kinds._fit_entry_point = lambda *given: (fit(*given), print(libraries()))[0]
support.small.passive_model()"""
    env = {name: its for name, its in os.environ.items() if not name.endswith("_NUM_THREADS")}
    found = subprocess.check_output([sys.executable, "-c", code], cwd=TESTS, env=env, text=True)
    assert {its["num_threads"] for its in eval(found) if its["user_api"] == "blas"} == {1}


@pytest.fixture(scope="module")
def mach1(mach1_file: Path) -> dict:
    found = mach1_recordings(mach1_file)
    return dict(zip(("0.1", "0.2", "0.5", "1", "2"), found, strict=True))


def percent_of_peak(kind: str, mach1: dict, held_out: str) -> float:
    training = [rec for name, rec in mach1.items() if name != held_out]
    model = fit_model(kind, "x", training, FitOptions(fraction=1.0)).model
    test = mach1[held_out]
    return accuracy([test.force_n], [predict_n(model, test)]).rmse_percent_of_peak


@pytest.mark.slow
@pytest.mark.parametrize(("held_out", "limit"), [("0.5", 1.6), ("2", 2.8)])
def test_the_papers_forest_on_a_frequency_it_never_saw(
    mach1: dict, held_out: str, limit: float
) -> None:
    # Eight times worse where positions in metres reach scikit-learn unscaled.
    assert percent_of_peak("rf-fd", mach1, held_out) < limit


PASSIVE_PERCENT = [("0.1", 0.7), ("0.2", 0.4), ("0.5", 0.45), ("1", 0.6), ("2", 1.1)]


@pytest.mark.few(0, 2)
@pytest.mark.parametrize(("held_out", "limit"), PASSIVE_PERCENT)
def test_the_passive_model_on_a_frequency_it_never_saw(
    mach1: dict, held_out: str, limit: float
) -> None:
    # With one rate of relaxation for all depths: 1.4, 0.7, 0.9, 1.1, 2.3.
    assert percent_of_peak("hammerstein", mach1, held_out) < limit


@pytest.mark.slow
@pytest.mark.parametrize(("held_out", "limit"), PASSIVE_PERCENT[::4])
def test_auto_is_as_good(mach1: dict, held_out: str, limit: float) -> None:
    assert percent_of_peak("auto", mach1, held_out) < limit + 0.05


LENGTH_M, AREA_M2, DT_S = 0.05, 1e-5, 0.25  # of a specimen: neither changes a share of the peak


@cache
def curves() -> dict[str, Recording]:
    found = {}
    for path in sorted((ROOT / "tests" / "data" / "vhb4910").glob("*.csv")):
        uneven_s, stretch, stress_kpa = np.loadtxt(path, delimiter=",", skiprows=1).T
        time_s = np.arange(0.0, uneven_s[-1], DT_S)
        position_m = LENGTH_M * np.interp(time_s, uneven_s, stretch - 1.0)
        force_n = 1e3 * AREA_M2 * np.interp(time_s, uneven_s, stress_kpa)
        found[path.stem] = Recording(path.stem, position_m, force_n, DT_S)
    return found


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("trained", "tested", "percent"),
    [("15 30", "20 25", 4.75), ("15 20 25 30", "15 20 25 30", 3.3)],
)
def test_vhb_in_tension(trained: str, tested: str, percent: float) -> None:
    """The passive model beside what others published of the same recordings.

    VHB 4910 to four stretches at three rates (Hossain, Vu, Steinmann 2012). The predictions that
    vCANN stores (arXiv 2303.12164) miss the eleven curves by 4.9 % of each one's peak, geometric
    mean, and the six of stretches 2.0 and 2.5 by 7.1 %.
    """

    def those(stretches: str) -> list[Recording]:
        names = ["loading_" + "d".join(word) for word in stretches.split()]
        return [its for name, its in curves().items() if name.startswith(tuple(names))]

    fit = train(those(trained), "hammerstein")
    errors = [rms(predict(fit, one) - one.force_n) / one.force_n.max() for one in those(tested)]
    assert len(errors) == (6 if tested == "20 25" else 11)
    assert 100.0 * geometric_mean(errors) < percent
