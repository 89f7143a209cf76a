"""The reference lists the keys of every command's --json: each that is printed, and no other."""

import ast
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from support import bench_folder
from support.in_process import spring
from support.paths import ROOT
from support.small import DT_S, press, recording, soft_force, training
from support.small_study import SOFT, rate_study, write_small_study

from springpot.host.cli import springpot
from springpot.host.wings.study.plan import read_plan
from springpot.trainer.recordings.recording_file import write_recording

PAGE = (ROOT / "docs" / "reference" / "json.md").read_text()
SCENE = 'schema = 1\nname = "x"\nmodel = "hammerstein.spm"\n'
# What is not run here, for it takes people, devices or minutes: where its result is put together.
BUILT = {
    "springpot demo": "host/wings/report/commands.py",
    "springpot place": "host/wings/lab/commands/place.py",
    "springpot report": "host/wings/report/commands.py",
    "springpot reproduce": "host/wings/evidence/paper/evidence.py",
    "springpot study run": "host/wings/study/session.py",
}
# Keys that only some devices, boards, kinds of model or failures have.
_SELDOM = {
    "springpot train": {"n_centers"},
    "springpot bench": {"points[].n_nodes", "points[].n_centers", "points[].pairs"},
}


def listed(command: str) -> set[str]:
    """Keys of a command's table; a.* stands for all that is in a."""
    (section,) = re.findall(rf"^## {command}\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S)
    rows = re.findall(r"^\| (`.*?`) \|", section, re.M)
    return {key for row in rows for key in re.findall(r"`([^`]+)`", row)}


def printed(value: Any, at: str = "") -> set[str]:
    """Paths of all values of a JSON object: a.b, a[].b; an empty object or list is its own."""
    if isinstance(value, dict) and value:
        below = (printed(item, f"{at}.{key}" if at else key) for key, item in value.items())
        return set().union(*below)
    if isinstance(value, list) and any(isinstance(item, dict) for item in value):
        return set().union(*(printed(item, f"{at}[]") for item in value))
    return {at}


def covers(key: str, path: str) -> bool:
    """Whether a listed key is that path, or all below a part of it.

    A path may end early, where a list or an object was empty, or null.
    """
    if key.endswith(".*"):
        return re.match(rf"{re.escape(key[:-2])}(\.|\[|$)", path) is not None
    return path == key or re.match(rf"{re.escape(path)}(\.|\[)", key) is not None


def compare(command: str, *runs: tuple[Any, ...]) -> None:
    """Assert that the runs print what the page lists, nothing more, and all of it in sum."""
    keys = listed(command)
    assert keys, command
    paths: set[str] = set()
    for arguments in runs:
        done = spring(*command.split()[1:], *arguments, "--json")
        assert done.returncode == 0, done.stderr
        paths |= printed(json.loads(done.stdout))
    unlisted = sorted(path for path in paths if not any(covers(key, path) for key in keys))
    assert not unlisted, f"{command}: docs/reference/json.md does not list {unlisted}"
    gone = {key for key in keys if not any(covers(key, path) for path in paths)}
    assert gone <= _SELDOM.get(command, set()), f"{command}: nothing prints {sorted(gone)}"


@pytest.fixture
def job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Recordings and a scene, in the folder where commands run."""
    monkeypatch.chdir(tmp_path)
    for name, items in (("training", training()), ("validation", [recording("v", press(0.9))])):
        Path(name).mkdir()
        for item in items:
            write_recording(Path(name) / f"{item.name}.h5", item)
    Path("scene.toml").write_text(SCENE)
    return tmp_path


def test_every_command_that_prints_json_has_a_table_and_the_page_no_other() -> None:
    context = click.Context(springpot)
    names = []
    for name in springpot.list_commands(context):
        found = springpot.get_command(context, name)
        commands: dict[str, click.Command | None] = {name: found}
        if isinstance(found, click.Group):
            inner = found.list_commands(context)
            commands = {f"{name} {one}": found.get_command(context, one) for one in inner}
        names += [
            f"springpot {full}" for full, command in commands.items()
            if command and any("--json" in option.opts for option in command.params)
        ]  # fmt: skip
    assert len(names) > 24
    assert sorted(re.findall(r"^## (springpot .*)", PAGE, re.M)) == sorted(names)


@pytest.mark.parametrize("command", BUILT)
def test_what_is_put_together_in_one_place_is_listed(command: str) -> None:
    tree = ast.parse((ROOT / BUILT[command]).read_text())
    literals = [
        {key.value for key in node.keys if isinstance(key, ast.Constant)}
        for node in ast.walk(tree)
        if isinstance(node, ast.Dict)
    ]
    tops = {re.split(r"[.\[]", key)[0] for key in listed(command)}
    assert tops in literals, f"{command}: {sorted(tops)} listed, {literals} in the code"


def test_of_recordings(job: Path) -> None:
    Path("short.toml").write_text(
        "[[profile]]\namplitude_n = 4.0\nfrequency_hz = 1.0\ncycles = 4\n"
    )
    position_m = np.concatenate([press(0.5, 0.010, 2), press(2.0, 0.008, 4), press(5.0, 0.006, 5)])
    columns = [np.arange(len(position_m)) * DT_S, position_m, soft_force(position_m)]
    np.savetxt("rig.csv", np.column_stack(columns), delimiter=",", comments="",
               header="time_s,position_m,force_N")  # fmt: skip
    compare(
        "springpot record",
        ("--device", "sim://ecoflex-00-30", "--protocol", "short.toml", "--out", "recorded"),
    )
    compare("springpot import", ("rig.csv", "--place", "5,10mm", "--out", "imported"))
    compare("springpot check", ("training",), ("imported",))
    compare("springpot export", ("training", "--to", "mat", "--out", "mat"))  # fmt: skip


@pytest.mark.slow
def test_of_models_and_scenes(job: Path) -> None:
    def fit(kind: str, *more: str) -> tuple[str, ...]:
        return ("training", "--model", kind, "--out", f"{kind}.spm", *more)

    Path("placed").mkdir()
    for k, pressed in enumerate(training()[:1] * 4):
        place = {"place_x_m": 0.01 * (k % 2), "place_y_m": 0.01 * (k // 2)}
        write_recording(Path(f"placed/{k}.h5"), replace(pressed, **place))
    compare("springpot train", fit("hammerstein", "--validate", "validation"), fit("rf-fd"),
            fit("springpot"), ("placed", "--model", "hammerstein", "--out", "map.spm"))  # fmt: skip
    compare("springpot predict", ("hammerstein.spm", "validation", "--out", "predicted"))
    compare("springpot material", ("springpot.spm", "--tip-mm", 6, "--height-mm", 35,
                                   "--accept-unidentified", "--out", "law"))  # fmt: skip
    compare("springpot emit", ("--scene", "scene.toml", "--out", "c"),
            ("--scene", "scene.toml", "--model", "rf-fd.spm", "--out", "forest"))  # fmt: skip
    compare("springpot build", ("c",))
    compare(
        "springpot validate", ("c", "--recording", "validation"), ("c", "--recording", "placed")
    )
    compare("springpot stability", ("--scene", "scene.toml"))


@pytest.mark.slow
def test_of_sessions(job: Path) -> None:
    shutil.copyfile(ROOT / "tests" / "golden" / "press" / f"{SOFT}.spm", "hammerstein.spm")
    compare("springpot run", ("--scene", "scene.toml", "--device", "sim://ecoflex-00-30",
                              "--seconds", 1, "--log", "felt.h5"))  # fmt: skip
    compare("springpot identify", ("--device", "sim://free", "--max-force-n", 2, "--yes"))
    compare("springpot doctor", ())


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("wasm-ld") is None, reason="no wasm-ld: apt-get install lld")
@pytest.mark.skipif(shutil.which("clang") is None, reason="no clang")
def test_of_a_page(job: Path) -> None:
    shutil.copyfile(ROOT / "tests" / "golden" / "press" / f"{SOFT}.spm", "hammerstein.spm")
    assert spring("emit", "--scene", "scene.toml", "--out", "c").returncode == 0
    compare("springpot page", ("c", "--out", "press.html"))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="no arm-none-eabi-gcc")
def test_of_firmware(job: Path) -> None:
    shutil.copyfile(ROOT / "tests" / "golden" / "press" / f"{SOFT}.spm", "hammerstein.spm")
    compare("springpot firmware", ("--scene", "scene.toml", "--board", "mps2-an386",
                                   "--out", "firmware"))  # fmt: skip


@pytest.mark.slow
def test_of_a_benchmark(job: Path) -> None:
    with bench_folder.small():
        compare("springpot bench", ("--recording", "training", "--validate", "validation",
                                    "--model", "hammerstein", "--out", "bench"))  # fmt: skip


def test_of_a_study(job: Path) -> None:
    write_small_study(job)
    compare("springpot study plan", ("study.toml", "--participants", 7, "--out", "plan"))
    rate_study(read_plan(Path("plan")), {}, leave=1)
    compare("springpot study report", ("plan",))
