"""Signs, units, columns and rates that are not what a file says: refused, told, or right."""

import json
from contextlib import suppress
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from support.files.mach1 import mach1_recordings
from support.files.recording_files import PressedObject

import springpot
from springpot import Recording, SpringpotError, check_recordings
from springpot.codegen.errors import DataError
from springpot.host.commands.import_ import import_
from springpot.host.validation.seen import accepted_signs_sentence
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.conditioning import Conditioning, condition
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.quality.signs import find_signs, sign_findings
from springpot.trainer.recordings.recording_file import read_recordings

TURN = "--map position=COL:-1mm,force=COL:-1N"


def run_import(*arguments: Any) -> dict[str, Any]:
    """The JSON object of `import`; raises what the command raises."""
    result = CliRunner().invoke(import_, [*map(str, arguments), "--json"])
    if result.exception:
        raise result.exception
    found: dict[str, Any] = json.loads(result.stdout)
    return found


@pytest.mark.few(1)
@pytest.mark.parametrize("motion_name", ["steps", "triangles", "single"])
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_a_specimen_that_pulls_on_the_way_back_shows_which_way_is_in(
    motion_name: str, exponent: float
) -> None:
    """Bonded to its plates, compressed from 0 on, by a machine that counts compression negative."""
    time_s = np.arange(0.0, 60.0, 0.02)
    knots = {
        "steps": ([0, 2, 15, 17, 30, 32, 45, 47, 60], [0, 1, 1, 2, 2, 3, 3, 0, 0]),
        "triangles": ([0, 10, 20, 30, 40, 50, 60], [0, 3, 0, 3, 0, 3, 0]),
        "single": ([0, 5, 30, 55, 60], [0, 0, 3, 0, 0]),
    }[motion_name]
    x = 1e-3 * np.interp(time_s, *knots)
    spring_n = 2000.0 * 3e-3 * (x / 3e-3) ** exponent
    force_n, memory = spring_n.copy(), 0.0
    for k, rise_n in enumerate(np.diff(spring_n, prepend=0.0)):
        memory = np.exp(-0.02 / 20.0) * (memory + 0.5 * rise_n)
        force_n[k] += memory
    assert force_n.min() < -0.05 * force_n.max()
    noisy_n = force_n + np.random.default_rng(1).normal(0.0, 0.005, len(x))
    right = Recording("right", x, noisy_n, 0.02)
    found = check_recordings([right])
    assert not found.refused and found.sign_words.startswith("position grows into the object")
    turned = Recording("turned", -x, -noisy_n, 0.02)
    conditioned = [turned]
    for shift_m, tare_n in ((3e-3, 0.0), (0.0, -6.0), (3e-3, -6.0)):
        details = {"contact_position_m": -shift_m, "tare_n": tare_n}
        conditioned.append(
            Recording("turned", shift_m - x, -noisy_n - tare_n, 0.02, details=details)
        )
    for recording in conditioned:
        with pytest.raises(DataError, match=TURN):
            check_recordings([recording]).refuse()


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_training_refuses_what_gives_energy() -> None:
    """Without `import` and `check` before it."""
    right = recording_of("presses")
    late = replace(right, force_n=np.roll(right.force_n, 20))
    mirrored = replace(late, position_m=-right.position_m, force_n=-right.force_n)
    for item, told in ((late, "no object gives any"), (mirrored, TURN.removeprefix("--map "))):
        with pytest.raises(DataError, match=told):
            springpot.train([item], "hammerstein")


def recording_of(kind: str) -> Recording:
    """Presses of two speeds from 1 mm above the surface on, or one that is held, at 200 Hz."""
    time_s = np.arange(2400) / 200.0
    swing = 0.5 - 0.5 * np.cos(2 * np.pi * np.cumsum(np.where(time_s < 6, 0.5, 1.5)) / 200.0)
    held_m = np.interp(time_s, [0, 1, 4, 8, 9, 12], [-1e-3, -1e-3, 5e-3, 5e-3, -1e-3, -1e-3])
    position_m = 6e-3 * swing - 1e-3 if kind == "presses" else held_m
    force_n = PressedObject(5e-3, 7.5, 2.0, 0.25).force(position_m, 1 / 200.0)
    return Recording(kind, position_m, force_n, 1 / 200.0)


def test_real_recordings_of_every_sign(shared_data: Path, mach1_file: Path) -> None:
    """Of those that were pressed, each of the four sign combinations is recognised."""
    compressed = mach1_recordings(mach1_file)
    for file in sorted((shared_data / "ecoflex_compression").rglob("*_A1.csv")):
        with suppress(SpringpotError):
            compressed.append(import_file(file, resample_hz=10.0)[0])
    assert len(compressed) >= 5 + 3
    for item, x, f in product(compressed, (1, -1), (1, -1)):
        raw_n = item.force_n + item.details.get("zero_force_n", 0.0)
        turned = replace(item, position_m=x * item.position_m, force_n=f * raw_n, details={})
        signs = find_signs(turned)
        assert (signs.position_sign, signs.force_sign) == (x, f)


def noisy(seed: int, peak_n: float, noise_n: float, loss: float) -> Recording:
    """One press of 5 mm in 1 s whose loop is `loss` of travel times peak, at 200 Hz."""
    rng, phase = np.random.default_rng(seed), np.linspace(0.0, 2.0 * np.pi, 200)
    depth = 0.5 * (1.0 - np.cos(phase))
    force_n = peak_n * (depth**1.5 + loss * 4.0 / np.pi * np.sin(phase) / 2.0)
    force_n += noise_n * rng.standard_normal(200)
    return Recording(f"{seed}", 5e-3 * depth, force_n, 5e-3, source="test")


def test_a_loop_that_noise_turns_is_not_refused() -> None:
    """A press of three times the noise; both errors of the gate are counted."""
    for peak_n, loss, kinds in ((0.3, 0.05, set()), (12.0, -0.05, {"energy"})):
        for item in (noisy(seed, peak_n, 0.1, loss) for seed in range(100)):
            assert {found.kind for found in sign_findings(item, find_signs(item))} == kinds


@pytest.mark.parametrize(("kind", "signs"), [("presses", (-1, 1)), ("one-press", (-1, -1))])
def test_signs_that_are_accepted_are_taken_kept_and_said(
    kind: str, signs: tuple[int, int], tmp_path: Path
) -> None:
    item = recording_of(kind)
    time_s = np.arange(len(item.force_n)) * item.dt_s
    rows = np.column_stack([time_s, 1e3 * signs[0] * item.position_m, signs[1] * item.force_n])
    np.savetxt(tmp_path / "press.csv", rows, "%.9g", ",", header="time_s,position_mm,force_N",
               comments="")  # fmt: skip
    asked = (tmp_path / "press.csv", "--out", tmp_path / "r")
    with pytest.raises(DataError, match="--accept-signs takes it so"):
        run_import(*asked)
    found = run_import(*asked, "--accept-signs")
    told = [finding for finding in found["findings"] if "--accept-signs" in finding["line"]]
    assert [finding["severity"] for finding in told] == ["warning"]
    (recording,) = read_recordings([tmp_path / "r"])
    assert recording.signs_accepted
    assert [f.kind for f in check_recordings([recording]).findings if "--accept" in f.line]
    turned = replace(recording, force_n=recording.force_n - recording.force_n.min())
    fit = fit_model("rf-fd", "x", [turned], FitOptions(trees=2, fraction=0.1))
    assert fit.model.provenance["accepted_signs"] == ["press"]
    manifest = {"provenance": fit.model.provenance, "left_out": []}
    assert "press" in accepted_signs_sentence(manifest)


@pytest.mark.parametrize("found", [{"tare": "auto"}, {"contact_force": "auto"}])
@pytest.mark.parametrize("offset_n", [-20.0, -1.0, 0.0, 5.0])
@pytest.mark.parametrize("power", [1.0, 1.5, 3.0])
def test_a_found_tare_hides_no_mirror_and_makes_none(
    power: float, offset_n: float, found: dict[str, Any]
) -> None:
    """Presses out of free air: right whatever the cell's offset, mirrored if both signs are."""
    time_s = np.arange(4000) / 500
    x = 2.5e-3 * (1 - np.cos(2 * np.pi * time_s / 2)) - 1e-3
    held = np.convolve(np.maximum(x, 0.0), np.exp(-np.arange(400) / 100) / 100)[: len(x)]
    noise = np.random.default_rng(1).normal(0, 5e-3, len(x))
    f = 8.0 * (np.maximum(x - 0.1 * held, 0.0) / 4e-3) ** power + noise
    right, _ = condition(Recording("x", x, f + offset_n, 2e-3), Conditioning(**found))
    assert not check_recordings([right]).refused
    if offset_n == 0.0:
        with pytest.raises(DataError, match="turn the sign round, importing such files alone: "):
            mirrored = condition(Recording("x", -x, -f, 2e-3), Conditioning(**found))[0]
            check_recordings([mirrored]).refuse()


def torn(law: str, after: str, air_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and force of one way in, at an even speed, to 6 mm and beyond what holds there."""
    position_m = np.arange(0.0, 10e-3, 5e-6)
    depth_m = np.maximum(position_m - air_m, 0.0)
    force_n = 50.0 * (depth_m / 6e-3) ** {"linear": 1.0, "stiffens": 1.6, "softens": 0.7}[law]
    beyond = np.flatnonzero(depth_m >= 6e-3)
    share = np.linspace(0.0, 1.0, len(beyond))
    falls = {"breaks": 0.0, "recoils": -0.04, "yields": 0.3 + 0.7 * np.exp(-40.0 * share)}
    force_n[beyond] = 50.0 * falls.get(after, 1.0 - share)
    return position_m, force_n + np.random.default_rng(1).normal(0.0, 0.02, len(position_m))


def test_an_object_that_flows_where_the_tool_slows_down_is_not_torn() -> None:
    x, f = torn("linear", "breaks", 0.0)
    slowly = np.linspace(0.0, 2e-3, 4000)
    f = np.append(f[:1200], f[1199] * (0.2 + 0.8 * np.exp(-np.arange(4000) / 300.0)))
    found = check_recordings([Recording("flows", np.append(x[:1200], x[1199] + slowly), f, 1e-2)])
    assert "tear" not in {each.kind for each in found.findings}


@pytest.mark.parametrize("law", ["linear", "stiffens", "softens"])
@pytest.mark.parametrize("after", ["breaks", "recoils", "yields", "fades"])
@pytest.mark.parametrize("air_m", [0.0, 1e-3])
def test_a_tear_is_named_and_hides_no_sign(law: str, after: str, air_m: float) -> None:
    x, f = torn(law, after, air_m)
    for position_sign, force_sign in product((1, -1), (1, -1)):
        item = Recording("torn", position_sign * x, force_sign * f, 1e-2)
        report = check_recordings([item])
        assert "tear" in {found.kind for found in report.findings}
        assert report.refused == (position_sign < 0 or force_sign < 0)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_single_way_in_shows_its_side_though_the_object_relaxes(power: float, side: int) -> None:
    share = np.linspace(0.0, 1.0, 2000)
    found = find_signs(Recording("x", 0.01 * side * share, side * (5.0 * share**power + 1.0), 1e-3))
    assert found.evidence and (found.position_sign, found.force_sign) == (side, side)


@pytest.mark.parametrize("seed", range(40))
def test_a_break_in_the_last_rows_turns_no_sign(seed: int) -> None:
    """Of presses with an offset, a preload, a rest before or a stop behind; both errors counted."""
    draw = np.random.default_rng(seed)
    rows, broken = int(draw.choice([20, 40, 80, 150, 1000])), int(draw.integers(3, 7))
    way, air = np.linspace(0.0, 1.0, rows), float(draw.choice([0.0, 0.1, 0.3]))
    force = np.maximum(way - air, 0.0) ** draw.choice([0.7, 1.0, 1.7])
    falls = np.linspace(draw.choice([1.0, 0.0]), 0.0, broken + 1)[1:]
    left = draw.uniform(-0.3, 0.5)
    force[-broken:] = force[-broken - 1] * (left + (1.0 - left) * falls)
    mode = str(draw.choice(["plain", "offset", "preload", "hold", "stop"]))
    if mode == "stop":
        way[-broken:] = way[-broken - 1]
    if mode == "hold":
        way, force = (np.append(np.full(rows // 3, each[0]), each) for each in (way, force))
    force += 0.05 * (mode == "preload") + draw.normal(0.0, 1e-3, len(way))
    position_m, force_n = 3e-3 * (way + draw.uniform(0.0, 2.0) * (mode == "offset")), 40.0 * force
    for x, f in product((1, -1), (1, -1)):
        item = Recording("a", x * position_m, f * force_n, 0.1, source="test")
        refused = [each for each in sign_findings(item, find_signs(item)) if each.kind == "sign"]
        assert (x == f == 1) != bool(refused)
