"""What to record next: within what was recorded, on what was not, and worth more than a repeat."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.in_process import spring
from support.small import DT_S, press, recording, training

from springpot.codegen.errors import DataError
from springpot.host.metrics import accuracy
from springpot.host.recording.protocols import Profile, load_protocol, validation
from springpot.host.simulation.bench import SimulatedBench
from springpot.host.simulation.objects import SimulatedObject
from springpot.host.wings.presses.coverage import find_coverage
from springpot.host.wings.presses.next_presses import NextPress, next_presses
from springpot.host.wings.presses.next_protocol import next_words, write_protocol
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import predict_n
from springpot.trainer.recordings.recording import Recording
from springpot.trainer.recordings.recording_file import write_recording

SMALL = "".join(f"[[profile]]\namplitude_n = {n}\nfrequency_hz = 1\n" for n in (2, 6, 10))


def chosen(recordings: list[Recording]) -> list[NextPress]:
    return next_presses(recordings, find_coverage(recordings).band_hz)


def cycles(*frequencies_hz: float) -> list[Recording]:
    return [recording(f"{hz:g}", press(hz)) for hz in frequencies_hz]


def test_three_presses_that_differ_within_what_was_recorded() -> None:
    recordings = list(training())
    found = chosen(recordings)
    peak_n = max(item.force_n.max() for item in recordings)
    assert len(found) == len({replace(item, before_n=0, after_n=0) for item in found}) == 3
    assert all(0 < item.amplitude_n <= peak_n for item in found)
    assert found == chosen(recordings)


def test_each_press_leaves_less_open() -> None:
    found = chosen(cycles(1.0))
    left_n = [found[0].before_n, *(item.after_n for item in found)]
    assert left_n == sorted(left_n, reverse=True)
    assert [item.before_n for item in found] == left_n[:-1]
    assert left_n[-1] < 0.5 * left_n[0]


def test_holds_that_are_there_are_not_asked_for_again() -> None:
    depth_m = press(1.0)
    rising, falling = depth_m[:500], depth_m[500:]
    held = [
        recording(
            f"held-{share}", share * np.concatenate([rising, np.full(9000, depth_m[500]), falling])
        )
        for share in (0.4, 0.7, 0.9, 1.0)
    ]
    assert any(item.hold_s for item in chosen(cycles(0.5, 2.0)))
    assert not any(item.hold_s for item in chosen([*cycles(0.5, 2.0), *held]))


def test_the_protocol_is_what_record_takes(tmp_path: Path) -> None:
    presses = [NextPress(7.5, frequency_hz=1.9, cycles=3), NextPress(10.0, hold_s=4.0)]
    write_protocol(tmp_path / "next.toml", presses)
    profiles = load_protocol(str(tmp_path / "next.toml"), 0)
    for profile, item in zip(profiles, presses, strict=True):
        assert len(profile.command_n) == round(1000 * item.duration_s)
        time_s = np.minimum(np.arange(len(profile.command_n)) / 1000, item.duration_s)
        np.testing.assert_allclose(profile.command_n, item.force_n(time_s), atol=1e-9)


def test_train_prints_and_writes_them(tmp_path: Path) -> None:
    (tmp_path / "rec").mkdir()
    for item in training():
        write_recording(tmp_path / "rec" / f"{item.name}.h5", item)
    train = ["train", tmp_path / "rec", "--model", "hammerstein", "--out", tmp_path / "m.spm"]
    shown = " ".join(spring(*train).stdout.split())
    assert "record next models that fit these recordings equally well differ by" in shown
    assert "--next FILE.toml writes them" in shown
    found = spring(*train, "--next", tmp_path / "next.toml", "--json")
    presses = json.loads(found.stdout)["next_presses"]
    assert len(presses) == 3
    assert [
        profile.metadata["amplitude_n"] for profile in load_protocol(str(tmp_path / "next.toml"), 0)
    ] == [item["amplitude_n"] for item in presses]
    refused = spring(*train, "--next", tmp_path / "next.txt")
    assert refused.returncode == 2
    assert "protocols end in .toml" in refused.stderr


def test_no_protocol_from_another_zero(tmp_path: Path) -> None:
    preloaded = recording("preloaded", 0.004 + press(1.0), zero="first")
    write_recording(tmp_path / "preloaded.h5", preloaded)
    train = ["train", tmp_path / "preloaded.h5", "--model", "hammerstein", "--out",
             tmp_path / "m.spm"]  # fmt: skip
    refused = spring(*train, "--next", tmp_path / "next.toml")
    assert refused.returncode == 2
    assert "the tool never leaves the object" in refused.stderr
    assert not (tmp_path / "m.spm").exists()
    assert "counted from the lowest recorded force" in " ".join(spring(*train).stdout.split())


def recorded(bench: SimulatedBench, profiles: list[Profile], again: str = "") -> list[Recording]:
    return [
        Recording(f"{profile.name}{again}", *bench.press(profile.command_n), DT_S)
        for profile in profiles
    ]


def error_n(training: list[Recording], others: list[Recording]) -> float:
    model = fit_model("hammerstein", "m", training, FitOptions()).model
    return accuracy([r.force_n for r in others], [predict_n(model, r) for r in others]).rmse_n


def ratio(folder: Path, name: str, seed: int) -> float:
    """Error with three presses asked for, over that with the protocol's own repeated."""
    (folder / "small.toml").write_text(SMALL)
    small = load_protocol(str(folder / "small.toml"), 0)
    bench = SimulatedBench(SimulatedObject(name, seed=seed))
    first, again = recorded(bench, small), recorded(bench, small, " again")
    write_protocol(folder / "next.toml", chosen(first))
    following = recorded(bench, load_protocol(str(folder / "next.toml"), 0), " next")
    other = SimulatedBench(SimulatedObject(name, seed=100 + seed))
    others = recorded(other, validation(seed)[:4])
    return error_n([*first, *following], others) / error_n([*first, *again], others)


def test_they_help_more_than_a_repeat(tmp_path: Path) -> None:
    assert ratio(tmp_path, "stiffening-tissue", 0) < 0.6


@pytest.mark.slow
def test_they_help_more_than_a_repeat_on_objects_of_other_physics(tmp_path: Path) -> None:
    logs = {
        name: [np.log(ratio(tmp_path, name, seed)) for seed in range(3)]
        for name in ("stiffening-tissue", "bergstrom-boyce", "ecoflex-00-30")
    }
    means = {name: float(np.exp(np.mean(values))) for name, values in logs.items()}
    assert all(mean < 0.7 for mean in means.values()), means
    assert float(np.exp(np.mean(list(logs.values())))) < 0.5, means


def test_a_force_that_lasts_no_longer_than_a_glitch_is_no_press(tmp_path: Path) -> None:
    position_m = np.linspace(0.0, 0.001, 400)
    tap = Recording("tap", position_m, np.where(np.arange(400) < 397, 0.0, 2.0), DT_S)
    assert chosen([tap]) == []
    assert next_words([], "surface", None).startswith("not known")
    with pytest.raises(DataError, match="record longer presses"):
        write_protocol(tmp_path / "next.toml", [])
