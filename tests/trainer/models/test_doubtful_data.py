"""Sets that hold no model, or an odd recording: refused or warned of in a line."""

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring

import springpot
from springpot import Recording
from springpot.codegen.errors import DataError, SpringpotError
from springpot.trainer.features import highpass
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.quality.repeats import find_noise_floor, find_repeats
from springpot.trainer.recordings.quality.report import check_recordings

DT_S = 0.002
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
KINDS = ("hammerstein", "rf-fd", "rbf-pv", "springpot")


def pad(name: str, depth_m: float, hz: float, seed: int | np.random.Generator) -> Recording:
    """A cubic spring and a Maxwell branch, met after 1 mm of air, with 10 mN of noise."""
    time_s = np.arange(0.0, 2.0, DT_S)
    rng = np.random.default_rng(seed)
    position_m = (depth_m + 1e-3) * (0.5 - 0.5 * np.cos(2.0 * np.pi * hz * time_s)) - 1e-3
    x = np.maximum(position_m, 0.0)
    force_n = np.maximum(300.0 * x + 4e6 * x**3 + 250.0 * highpass(x, 0.15, DT_S), 0.0)
    noise_n = 0.01 * rng.standard_normal(len(x))
    return Recording(name, position_m, force_n + noise_n, DT_S, zero="none")


def pads() -> list[Recording]:
    rng = np.random.default_rng(5)
    return [pad(f"p{k}", rng.uniform(3e-3, 10.5e-3), rng.uniform(0.3, 3.0), rng) for k in range(9)]


def noise(recordings: list[Recording]) -> list[Recording]:
    rng = np.random.default_rng(0)
    return [replace(each, force_n=rng.standard_normal(len(each.force_n))) for each in recordings]


def lines_of(recordings: list[Recording], kind: str = "hammerstein") -> tuple[str, ...]:
    return springpot.train(recordings, kind).warnings


@pytest.mark.parametrize("place", [0, 9])
def test_a_recording_in_another_unit_spoils_no_start_wherever_it_stands(place: int) -> None:
    """The last one left a state 60 mm deep, with which every press began: 31 % of the force."""
    recordings = pads()
    odd = replace(recordings[4], name="cm", position_m=10.0 * recordings[4].position_m)
    recordings.insert(place, odd)
    model = springpot.train(recordings, "hammerstein").model
    for recording in recordings:
        missed_n = predict_n(model, recording) - recording.force_n
        assert np.sqrt(np.mean(missed_n**2)) < 0.15 * model.trained.max_n


def test_repeats_agree_in_position_and_force() -> None:
    press = pad("press", 6e-3, 0.5, 0)
    again = pad("again", 6e-3, 0.5, 1)
    assert len(find_repeats([press, again])) == 1
    for odd in (
        replace(press, name="cm", position_m=10.0 * press.position_m),
        replace(press, name="twice", force_n=2.0 * press.force_n),
    ):
        assert not find_repeats([press, odd])
        assert find_noise_floor([press, odd]).source != "repeats"


@pytest.mark.parametrize("kind", KINDS)
def test_noise_trains_no_model(kind: str) -> None:
    with pytest.raises(DataError, match=r"p0: force does not depend on position.*accept.misfit"):
        springpot.train(noise(pads()), kind)


def test_noise_is_accepted_and_its_signs_are_no_evidence() -> None:
    (found,) = noise([pad("p", 8e-3, 0.5, 0)])
    assert springpot.train([found], "hammerstein", accept_misfit=True).model
    for seed in range(8):
        force_n = np.random.default_rng(seed).standard_normal(len(found.force_n))
        report = check_recordings([replace(found, force_n=force_n)])
        assert not any(finding.kind == "sign" for finding in report.findings)


def test_a_hold_that_relaxes_depends_on_its_position(caplog: pytest.LogCaptureFixture) -> None:
    time_s = np.arange(0.0, 20.0, DT_S)
    depth_m = 8e-3 * np.clip(time_s / 0.3, 0.0, 1.0)
    hold = Recording("h", depth_m, 300.0 * depth_m * (0.3 + 0.7 * np.exp(-time_s / 0.8)), DT_S)
    assert not lines_of([hold])
    assert "h: one recording, of one depth and speed: " in caplog.text


@pytest.mark.parametrize("kind", ["hammerstein", "rf-fd"])
def test_a_training_recording_that_is_missed_is_named(kind: str) -> None:
    recordings = pads()
    hardest = max(recordings, key=lambda each: float(each.force_n.max()))
    recordings.append(replace(hardest, name="odd", force_n=3.0 * hardest.force_n))
    (line,) = [line for line in lines_of(recordings, kind) if "is missed by" in line]
    assert re.match(
        rf"{kind}: (odd|{hardest.name}), a training recording, is missed by \d\d % of", line
    )
    recordings[-1] = replace(recordings[-1], force_n=-0.5 * hardest.force_n)
    with pytest.raises(SpringpotError, match=r"missed by .*accept.misfit"):
        fit_model(kind, "x", recordings, FitOptions())


def test_what_misses_the_validation_is_not_written(tmp_path: Path) -> None:
    recordings, model = pads(), tmp_path / "m.spm"
    springpot.write_recordings(tmp_path / "training", recordings)
    other = replace(pad("other", 8e-3, 0.5, 9), force_n=4.0 * pad("other", 8e-3, 0.5, 9).force_n)
    springpot.write_recordings(tmp_path / "validation", [other])
    words = ("train", tmp_path / "training", "--model", "hammerstein", "--out", model,
             "--validate", tmp_path / "validation")  # fmt: skip
    refused = spring(*words)
    assert refused.returncode == 1 and not model.exists()
    assert re.search("validation recordings are missed by .*--accept-misfit", refused.stderr)
    accepted = spring(*words, "--accept-misfit")
    assert accepted.returncode == 0 and "warning: m: the validation rec" in accepted.stderr


@pytest.mark.parametrize(
    ("kind", "rows", "needed"),
    [*((kind, rows, 50) for kind in KINDS[:-1] for rows in (5, 30)), ("springpot", 5, 10)],
)
def test_too_few_samples_train_no_model(kind: str, rows: int, needed: int) -> None:
    short = pad("short", 8e-3, 0.5, 0)
    short = replace(
        short, position_m=short.position_m[300 : 300 + rows], force_n=short.force_n[300:][:rows]
    )
    with pytest.raises(DataError, match=f"short: {rows} samples .*needs {needed}: record"):
        springpot.train([short], kind)


def test_trees_of_a_row_each_warn_of_nothing_but_their_misfit() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fit = springpot.train(pads(), "rf-fd", trees=2, tree_rows=1e-5, accept_misfit=True)
    assert {str(each.message) for each in caught} <= set(fit.warnings)


def test_one_press_says_that_others_are_not_known(caplog: pytest.LogCaptureFixture) -> None:
    assert not lines_of(pads()) and "not known: record more" not in caplog.text
    assert not lines_of([pad("p", 8e-3, 0.5, 0)])  # told, and no warning: nothing is wrong
    assert "the error on others is not known: record more" in caplog.text


def test_a_stroke_of_noise_is_no_press() -> None:
    rng = np.random.default_rng(0)
    jitter_m, force_n = rng.standard_normal((2, 4000)) * [[1e-6], [0.01]]
    still = Recording("still", jitter_m, 1.0 + force_n, DT_S)
    with pytest.raises(DataError, match="still: each position is unlike the one before"):
        fit_model("hammerstein", "x", [still], FitOptions())


def steps(relaxed_s: float, each: int, seed: int) -> Recording:
    """Steps between depths, with a force that relaxes to almost nothing after each."""
    rng = np.random.default_rng(seed)
    depth_m = np.repeat(rng.uniform(1e-3, 5e-3, 4000 // each), each)
    force_n = np.maximum(2000.0 * highpass(depth_m, relaxed_s, 0.01) + 20.0 * depth_m, 0.0)
    noise_n = 0.01 * rng.standard_normal(len(depth_m))
    return Recording("steps", depth_m, force_n + noise_n, 0.01)


@pytest.mark.parametrize("kind", ["hammerstein", "springpot"])
@pytest.mark.parametrize("relaxed_s", [0.1, 0.5])
@pytest.mark.parametrize("seed", range(3))
def test_steps_that_relax_depend_on_their_position(kind: str, relaxed_s: float, seed: int) -> None:
    assert springpot.train([steps(relaxed_s, 100, seed)], kind, accept_misfit=False).model


@pytest.mark.parametrize("per_cycle", [4, 5, 8])
def test_a_press_of_few_samples_a_cycle_is_no_noise(per_cycle: int) -> None:
    cycle = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(600) / per_cycle)
    sparse = Recording("sparse", 5e-3 * cycle - 5e-4, 2.0 * cycle, 1 / 30)
    assert springpot.train([sparse], "hammerstein").model


def test_a_law_of_few_numbers_is_fitted_to_few_samples() -> None:
    few = pad("few", 8e-3, 0.5, 0)
    few = replace(few, position_m=few.position_m[::25], force_n=few.force_n[::25], dt_s=25 * DT_S)
    assert len(few.force_n) == 40 and springpot.train([few], "springpot").model


def test_a_fraction_that_leaves_too_few_samples_is_named() -> None:
    with pytest.raises(DataError, match=r"10 of 1000 samples .*or give a larger --?fraction"):
        fit_model("rf-fd", "x", [pad("p", 8e-3, 0.5, 0)], FitOptions(fraction=0.01))
