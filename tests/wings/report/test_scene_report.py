"""The page on an emitted scene: what it says first, and how it looks on a phone and on paper."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.browser import A4_PIXELS, NEEDS_CHROMIUM, as_printed, layout_faults
from support.small import DT_S, model_file, press, recording, scene, small_model

from springpot.codegen.plan.make_plan import make_plan
from springpot.host.commands.scenes.validate import validation_rows
from springpot.host.emission.emission import emit
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.stability.check import Stability, stability as whole_check
from springpot.host.stability.judgement import Grade
from springpot.host.validation.store import Series, store_validation
from springpot.host.validation.validation import validate
from springpot.host.wings.report import scene_page as report
from springpot.host.wings.report.error_parts import errors_by_speed, tool_speed
from springpot.host.wings.report.findings import relaxation_finding
from springpot.host.wings.report.frequency_loops import frequency_loops
from springpot.host.wings.report.relaxation import (
    Hold,
    recorded_hold,
    relaxed_share,
    scene_hold,
    settled_after_s,
)
from springpot.host.wings.report.stability_page import write_stability_report


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("emitted")
    emit(scene(), model_file(folder, small_model()), folder / "c")
    return folder / "c"


@pytest.fixture(scope="module")
def pages(emitted: Path) -> dict[str, str]:
    """The joint page and that of the stability check; the check runs once for both."""
    held = np.concatenate([press(1.0)[:300], np.full(1500, press(1.0)[299])])
    recordings = [recording("press", press(0.9)), recording("held", held)]
    store_validation(emitted, validate(emitted, recordings, paced_s=0.1))
    kept: list[Stability] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "stability", lambda plan: kept.append(whole_check(plan)) or kept[0])
        joint = report.write_report(emitted)
    write_stability_report(kept[0], emitted.parent / "stability.html")
    return {
        "report": joint.read_text(),
        "stability": (emitted.parent / "stability.html").read_text(),
    }


def series(position_m: np.ndarray, error_n: np.ndarray | float = 0.0) -> Series:
    measured_n = 300.0 * position_m
    return Series("made", DT_S, position_m, measured_n, measured_n + error_n)


def test_an_error_is_found_where_the_speed_is() -> None:
    position_m = press(1.0, cycles=4)
    speed = tool_speed(series(position_m))
    fast_in = speed > 0.8 * speed.max()
    rows = errors_by_speed([series(position_m, np.where(fast_in, 1.0, 0.0))], [0])
    assert [row.low_mps for row in rows] == sorted(row.low_mps for row in rows)
    assert sum(row.samples for row in rows) == len(position_m)
    assert rows[0].rmse_n == 0.0
    assert rows[-1].mean_out_n == 0.0
    assert rows[-1].mean_in_n is not None
    assert rows[-1].mean_in_n > 0.5
    assert rows[-1].high_mps == pytest.approx(speed.max())
    assert sum(row.samples for row in errors_by_speed([series(position_m)], [50])) == (
        len(position_m) - 50
    )


def test_a_sum_of_sines_is_a_loop_a_frequency() -> None:
    time_s = np.arange(20_000) * DT_S
    parts = [(0.7, 0.003, 0.0), (2.3, 0.002, 0.4)]
    position_m = 0.008 + sum(a * np.cos(2 * np.pi * f * time_s + p) for f, a, p in parts)
    force_n = sum(500.0 * a * np.cos(2 * np.pi * f * time_s + p + 0.2) for f, a, p in parts)
    rows = frequency_loops(Series("sum", DT_S, position_m, force_n, 1.1 * force_n))
    assert [round(row.frequency_hz, 2) for row in rows] == [0.7, 2.3]
    for row, (_, amplitude_m, _) in zip(rows, parts, strict=True):
        assert row.depth_m == pytest.approx(amplitude_m, rel=0.01)
        assert abs(row.measured) / row.depth_m == pytest.approx(500.0, rel=0.01)
        assert np.angle(row.measured) == pytest.approx(0.2, abs=0.01)
        assert abs(row.predicted) == pytest.approx(1.1 * abs(row.measured), rel=0.01)


def test_what_holds_still_is_found() -> None:
    still = np.concatenate([press(1.0)[:500], np.full(3000, press(1.0)[499]), press(1.0)[500:]])
    found = recorded_hold([series(press(1.0)), series(still)])
    assert found.seconds == pytest.approx(3.0, abs=0.15)
    assert found.depth_m == pytest.approx(press(1.0)[499], rel=0.01)
    assert recorded_hold([series(press(1.0))]) is None
    assert recorded_hold([series(np.zeros(5000))]) is None


def test_a_window_does_not_relax_beyond_itself(emitted: Path) -> None:
    plan = make_plan(small_model(), scene())
    hold = scene_hold(plan, Replay(SceneLibrary(emitted)))
    assert hold.seconds == pytest.approx(60.0)
    assert 0.0 < relaxed_share(hold.force_n) < 0.5
    assert settled_after_s(hold) <= plan.model.memory_s == pytest.approx(0.171)
    found = relaxation_finding(plan, hold, None)
    assert "does not relax beyond 0.17 s" in found.words
    assert "what the object does is not known" in found.words
    assert found.grade == Grade.LOOK
    assert found.todo


def test_a_measured_hold_stands_beside(emitted: Path) -> None:
    plan = make_plan(small_model(), scene())
    creeping = 5.0 - np.log10(1.0 + np.arange(60_000) * DT_S)
    hold = Hold("C", 0.005, DT_S, creeping)
    alike = Hold("r", 0.005, DT_S, creeping, creeping + 0.01)
    flat = Hold("r", 0.005, DT_S, np.full(60_000, 5.0), creeping)
    good, doubtful = (relaxation_finding(plan, hold, item) for item in (alike, flat))
    assert good.grade == Grade.GOOD
    assert not good.todo
    assert doubtful.grade == Grade.LOOK
    assert "the object loses 35.7 %, the C 0.0 %" in doubtful.words


def test_the_page_says_first_what_to_act_on(pages: dict[str, str]) -> None:
    page = pages["report"]
    short = page[page.index("In short") : page.index("<h2>Accuracy</h2>")]
    for told in ("Accuracy", "Mean error", "Relaxation", "Stability", "Left out", "Cost",
                 "does not relax beyond 0.17 s", "linear loop"):  # fmt: skip
        assert told in short
    assert short.count('class="grade') >= 6
    assert page.index("lost-1") < page.index("Reproduce") < page.index('class="provenance"')


def test_an_error_stands_beside_the_noise_floor_and_what_a_hand_can_tell(
    emitted: Path, pages: dict[str, str]
) -> None:
    noisy = [
        replace(item, force_n=item.force_n + np.random.default_rng(k).normal(0, 0.02, 1000))
        for k, item in enumerate([recording("a", press(1.0)), recording("b", press(1.0))])
    ]
    found = validate(emitted, noisy, paced_s=0.1)
    rows = validation_rows(found)
    assert rows["error / noise floor"].endswith(" N, from 2 repeats of one press)")
    assert rows["error / JND"].startswith(f"{found.as_dict()['error_per_jnd']:.3g}, rms")
    page = " ".join(pages["report"].split())
    assert "noise floor not known: no press is repeated, and the force shows no noise" in page
    assert "times the just noticeable difference" in page


@NEEDS_CHROMIUM
@pytest.mark.parametrize("name", ["report", "stability"])
@pytest.mark.parametrize("width", [400, 1280, A4_PIXELS])
def test_nothing_sticks_out_and_no_word_is_cut(
    pages: dict[str, str], tmp_path: Path, name: str, width: int
) -> None:
    page = as_printed(pages[name]) if width == A4_PIXELS else pages[name]
    assert layout_faults(page, tmp_path, width) == {"out": [], "cut": []}
