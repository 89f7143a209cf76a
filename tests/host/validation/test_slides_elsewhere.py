"""A slide keeps its places through every way in and out, and nothing takes it for a press."""

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from codegen.stages.test_lateral import plan_of
from support.files.columns import write_columns
from support.small import passive_model

from springpot import DataError, FitOptions, Recording, UsageError, check_recordings
from springpot.host.validation.parts import require_slides
from springpot.host.wings.evidence.benchmark.run import Bench, run_bench
from springpot.modelling import fit_model, limited_n
from springpot.trainer.recordings.conditioning import Conditioning, condition
from springpot.trainer.recordings.formats.importing import ImportOptions, import_file
from springpot.trainer.recordings.recording_file import read_recording, write_recording
from springpot.trainer.recordings.slides import LATERAL, is_slide

HEADER = "time_s,position_m,force_N,place_x_mm,place_y_mm"
N, DT_S = 500, 1e-3


def slid(seed: int, axes: int = 4) -> Recording:
    """Channels that are smooth functions of time, (N,), the lateral force of the same cell."""
    draw, time_s = np.random.default_rng(seed), DT_S * np.arange(N)
    depth_m = 0.005 * (1.0 - np.cos(20.0 * time_s))
    waves = np.sin(np.outer(draw.uniform(3.0, 9.0, axes), time_s) + draw.uniform(0, 6, (axes, 1)))
    size = np.array([0.01, 0.01, 0.5, 0.5])[:axes, None]
    channels = dict(zip(LATERAL, size * waves, strict=False))
    return Recording("slid", depth_m, 300.0 * depth_m, DT_S, channels=channels)


def same(one: Recording, other: Recording) -> None:
    assert one.channels.keys() == other.channels.keys() and one.place_m == other.place_m
    for name, samples in one.channels.items():
        assert samples.tobytes() == other.channels[name].tobytes()
    assert one.force_n.tobytes() == other.force_n.tobytes()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("placed", [False, True])
def test_places_come_back_by_every_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int, placed: bool
) -> None:
    given = slid(seed, axes=2 + 2 * (seed % 2))
    if placed:
        x_m, y_m = np.random.default_rng(seed).uniform(-0.1, 0.1, 2).tolist()
        given = replace(given, channels={}, place_x_m=x_m, place_y_m=y_m)
    for form in ("csv", "mat"):
        file = write_columns(tmp_path / f"{given.name}.{form}", given)
        same(import_file(file, None, "none", None).recordings[0], given)
    write_recording(tmp_path / "slid.h5", given)
    same(read_recording(tmp_path / "slid.h5"), given)
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    same(Recording.from_frame(given.to_frame(), "slid"), given)


@pytest.mark.parametrize("delay_s", [0.0043, -0.0071])
def test_align_shifts_what_the_cell_feels_and_cuts_all_alike(delay_s: float) -> None:
    given = slid(5)
    late = slice(8, N - 8)
    at_s = DT_S * np.arange(N)[late]
    found, _ = condition(given, Conditioning(force_delay_s=delay_s, align=True))
    first = round(found_start(given, found))
    for name, samples in {**given.channels, "force_n": given.force_n}.items():
        its = found.force_n if name == "force_n" else found.channels[name]
        shift_s = delay_s if name.endswith("_n") else 0.0
        expected = np.interp(at_s + shift_s, DT_S * np.arange(N), samples)
        np.testing.assert_allclose(its[8 - first : N - 8 - first], expected, atol=1e-4)


def found_start(given: Recording, found: Recording) -> int:
    """Sample of a recording at which a cut one begins."""
    return int(np.flatnonzero(given.channels["x_m"] == found.channels["x_m"][0])[0])


def test_a_stage_that_trembles_stays(tmp_path: Path) -> None:
    draw = np.random.default_rng(0)
    base = slid(0)
    place_mm = np.array([5.0, -3.0]) + draw.uniform(-0.03, 0.03, (N, 2))
    table = np.column_stack([DT_S * np.arange(N), base.position_m, base.force_n, place_mm])
    np.savetxt(tmp_path / "a.csv", table, "%.9g", ",", header=HEADER, comments="")
    (found,) = import_file(tmp_path / "a.csv", None, "none", None).recordings
    assert not is_slide(found) and found.place_m == pytest.approx((5e-3, -3e-3), abs=5e-5)


def test_columns_that_say_a_place_twice_or_by_half(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    rows = "".join(f"{k / 1000},{k / 1e4},{k},1,{k},0.5\n" for k in range(20))
    for ends, words in {
        "place_x_mm,place_x_mm,b": "2 columns are named place_x",
        "place_x_mm,place_y_mm,lateral_x_N": "lateral_x and lateral_y belong together",
        "place_x_mm,b,c": "place_x and place_y belong together",
    }.items():
        file.write_text(f"time_s,position_m,force_N,{ends}\n{rows}")
        with pytest.raises(DataError, match=words):
            import_file(file, None, "none", None)
    file.write_text(f"time_s,position_m,force_N,b,c,lateral_x_N\n{rows}")  # nothing slides here
    assert not import_file(file, None, "none", None).recordings[0].channels
    with pytest.raises(UsageError, match="--place: the tool slides"):
        file.write_text(f"time_s,position_m,force_N,place_x_mm,place_y_mm,c\n{rows}")
        import_file(file, None, "none", None, ImportOptions(place_m=(0.0, 0.0)))


@pytest.mark.slow
def test_what_is_of_one_place_refuses_a_slide(tmp_path: Path) -> None:
    slide = slid(1)
    press = replace(slide, name="press", channels={})
    with pytest.raises(DataError, match="slid: slides"):
        fit_model("hammerstein", "m", [press], FitOptions(), [slide])
    with pytest.raises(DataError, match="slid: slides"):
        run_bench(Bench((press,), (slide,), "host"), tmp_path, "")
    with pytest.raises(DataError, match="slid: slides"):
        limited_n(passive_model(), slide)
    (figures,) = check_recordings([slide]).recordings
    assert "not judged" in figures["signs"]["words"]


@pytest.mark.parametrize("name", LATERAL)
@pytest.mark.parametrize("value", [np.nan, np.inf, 15.0])
def test_no_number_and_millimetres_are_no_path(name: str, value: float) -> None:
    plan = plan_of()
    slide = slid(2)
    require_slides(plan, slide)
    wrong = slide.channels[name].copy()
    wrong[7] = value
    other = replace(slide, channels={**slide.channels, name: wrong})
    if name.endswith("_n") and np.isfinite(value):
        require_slides(plan, other)
        return
    with pytest.raises(DataError, match=rf"slid: {name}"):
        require_slides(plan, other)


@pytest.mark.parametrize("offset_n", [-0.2, 0.05])
def test_a_tare_that_is_found_is_that_of_all_axes(offset_n: float) -> None:
    given = slid(3)
    air_m = given.position_m - 0.003
    draw = np.random.default_rng(1)
    force_n = 300.0 * np.maximum(air_m, 0.0)
    clean = {name: given.channels[name] * (force_n > 0.0) for name in LATERAL[2:]}
    noisy = {name: its + offset_n + draw.normal(0.0, 1e-3, N) for name, its in clean.items()}
    loaded = replace(
        given, position_m=air_m, force_n=force_n + 0.3 + draw.normal(0.0, 1e-3, N),
        channels={**given.channels, **noisy},
    )  # fmt: skip
    found, (line,) = condition(loaded, Conditioning(tare="auto"))
    assert "N along x" in line and "N along y" in line
    for name, its in clean.items():
        np.testing.assert_allclose(found.channels[name], its, atol=6e-3)
    stated, _ = condition(loaded, Conditioning(tare=0.3))
    assert stated.channels == loaded.channels
