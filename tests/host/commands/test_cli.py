"""The commands as a user runs them: exit statuses, one-line refusals, JSON keys, files."""

import json
import os
import re
import resource
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import click
import pytest
from support.in_process import spring
from support.peer import cli
from support.small import model_file, training

from springpot.host.cli import springpot as command_line
from springpot.trainer.recordings.hdf5_file import write_recording


def run(*arguments: object, env: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """In a process of its own where it gets another environment."""
    if env is None:
        return spring(*arguments)
    return cli(*arguments, errors="replace", timeout=100, env={**os.environ, **env})


def refusal(status: int, *arguments: object, env: dict[str, str] | None = None) -> str:
    """Run, assert the exit status and that standard error is one line; return it."""
    result = run(*arguments, env=env)
    assert result.returncode == status, result.stderr
    assert result.stdout == ""
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    assert lines[0].startswith("springpot: ")
    return lines[0]


@pytest.mark.slow
def test_train_emit_build_validate_report(job: Path) -> None:
    trained = run("train", job / "rec", "--model", "rf-fd", "--out", job / "m.spm", "--seed", 5,
                  "--validate", job / "rec", "--json")  # fmt: skip
    assert trained.returncode == 0, trained.stderr
    metadata = json.loads(trained.stdout)
    assert metadata["rows"] == metadata["rows_total"] < 20_000
    assert metadata["window_s"] == pytest.approx(0.171) and 0 < metadata["rmse_percent_of_peak"] < 3
    emitted = run("emit", "--scene", job / "scene.toml", "--model", job / "m.spm",
                  "--out", job / "c", "--json")  # fmt: skip
    assert emitted.returncode == 0, emitted.stderr
    metadata = json.loads(emitted.stdout)
    assert metadata["flash_bytes"] > 10_000 and 0 < metadata["ram_bytes"] < 2000
    assert 0 < metadata["stack_bytes"] < 2000 and metadata["compile_s"] > 0
    assert Path(run("build", job / "c").stdout.strip()).suffix == ".so"
    validated = run("validate", job / "c", "--recording", job / "rec", "--json")
    assert validated.returncode == 0, validated.stderr
    result = json.loads(validated.stdout)
    assert result["mismatches"] == 0 and result["hash"] == metadata["hash"]
    assert result["notes"]["resync"] == len(training())
    assert 0 < result["tick_ns"]["hot_median"] <= result["tick_ns"]["max"]
    reported = run("report", job / "c", "--json")
    assert reported.returncode == 0, reported.stderr
    page = Path(json.loads(reported.stdout)["report"]).read_text()
    assert page.count("<svg") == 3 and metadata["hash"] in page
    assert set(re.findall(r"https?://[\w.]+", page)) <= {"http://www.w3.org"}


@pytest.mark.parametrize("kind", ["hammerstein", "rbf-pv"])
def test_train_prints_the_error_from_either_start(kind: str, job: Path, tmp_path: Path) -> None:
    words = "train", job / "rec", "--model", kind, "--out", tmp_path / "m.spm", "--validate"
    done = [run(*words, job / "rec", "--start", start, "--json") for start in ("auto", "continues")]
    errors_n = json.loads(done[0].stdout)["rmse_by_start_n"]
    assert json.loads(done[0].stdout)["rmse_n"] in errors_n.values()
    if kind == "hammerstein":
        assert json.loads(done[1].stdout)["rmse_n"] == errors_n["continues"]
    else:  # features begin at rest, whatever came before
        assert errors_n["continues"] is None
        assert done[1].returncode == 2 and "rbf-pv keeps no state" in done[1].stderr


def test_without_a_compiler_the_c_is_still_written(job: Path, tmp_path: Path) -> None:
    empty = tmp_path / "bin"
    empty.mkdir()
    model = model_file(tmp_path)
    emit = ("emit", "--scene", job / "scene.toml", "--model", model, "--out", tmp_path / "c")
    result = run(*emit, "--json", env={"PATH": str(empty)})
    assert result.returncode == 0, result.stderr
    assert "no C compiler on PATH" in result.stderr
    assert json.loads(result.stdout)["flash_bytes"] is None
    nothing_built = {"PATH": str(empty), "XDG_CACHE_HOME": str(tmp_path)}
    assert "apt-get install gcc" in refusal(1, "build", tmp_path / "c", env=nothing_built)
    told = run("train", job / "rec", "--out", tmp_path / "new.spm", env=nothing_built)
    assert told.returncode == 1 and "apt-get install gcc" in told.stderr.splitlines()[-1]


@pytest.mark.slow
def test_validation_is_at_the_rate_of_the_scene(job: Path, tmp_path: Path) -> None:
    """Poles are exact at any rate: a scene may have another one than the model's recordings."""
    slow = tmp_path / "scene.toml"
    slow.write_text((job / "scene.toml").read_text() + "[runtime]\nrate_hz = 500\n")
    model_file(tmp_path)
    assert run("emit", "--scene", slow, "--out", tmp_path / "c").returncode == 0
    whole = training()[0]
    half = replace(whole, position_m=whole.position_m[::2], force_n=whole.force_n[::2], dt_s=2e-3)
    for item, name in ((whole, "whole"), (half, "half")):
        write_recording(tmp_path / f"{name}.h5", item)
    told = refusal(3, "validate", tmp_path / "c", "--recording", tmp_path / "whole.h5")
    assert "sampled at 1000 Hz, the scene at 500 Hz" in told
    found = run("validate", tmp_path / "c", "--recording", tmp_path / "half.h5", "--json")
    assert json.loads(found.stdout)["rmse_percent_of_peak"] < 5


def words_of(group: click.Group, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name in group.list_commands(click.Context(group)):
        command = group.get_command(click.Context(group), name)
        if isinstance(command, click.Group):
            yield from words_of(command, (*above, name))
            continue
        for one in command.params if command else ():
            if isinstance(one, click.Argument):
                yield (*above, name, "")
            elif isinstance(one, click.Option) and not one.is_flag:
                yield (*above, name, one.opts[0], "")
                yield (*above, name, f"{one.opts[0]}=")


def test_no_command_takes_an_empty_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given = list(words_of(command_line))
    assert ("import", "") in given and ("study", "plan", "--out=") in given
    for words in given:
        done = spring(*words)
        assert done.returncode == 2, words
        assert "is empty" in done.stderr, done.stderr
        assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_log_is_compared_with_the_c_and_leaves_the_validation_alone(job: Path) -> None:
    press_file, log = job / "press.h5", job / "felt.h5"
    validated = spring("validate", job / "c", "--recording", press_file)
    assert validated.stdout.startswith("verdict") and "ticks with notes" not in validated.stdout
    before = (job / "c" / "validation" / "result.json").read_text()
    device = f"replay://{press_file}"
    spring("run", "--scene", job / "c", "--device", device, "--log", log)
    felt = spring("validate", job / "c", "--recording", log)
    assert felt.returncode == 0, felt.stderr
    words = " ".join(felt.stdout.split())
    assert "what was felt is what the model says" in words
    assert "not with a measured object" in words and "RMSE" not in words
    assert (job / "c" / "validation" / "result.json").read_text() == before
    other = spring("run", "--scene", job / "c", "--device", "sim://ecoflex-00-30?variant=b")
    assert other.returncode == 2 and "leave them out where a scene is rendered" in other.stderr


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
ROWS = "".join(f"{k / 100},{k % 7},{k % 7}\n" for k in range(400))
TABLE = f"time_s,position_mm,force_N\n{ROWS}"


@pytest.mark.slow
@pytest.mark.parametrize("locale", [{}, ASCII])
@pytest.mark.parametrize("name", [b"gel\xff\xfe.csv", "gelä→.csv".encode()])
def test_any_file_name_is_imported(name: bytes, locale: dict[str, str], tmp_path: Path) -> None:
    file = tmp_path / os.fsdecode(name)
    file.write_text(TABLE)
    done = run("import", file, "--out", tmp_path / "out", env=locale)
    assert "Traceback" not in done.stderr
    assert done.returncode == 0, done.stderr
    missing = run("check", f"{file}x", env=locale)
    assert (missing.returncode, "Traceback" in missing.stderr) == (3, False), missing.stderr


@pytest.mark.few(1)
@pytest.mark.parametrize("command", ["import", "check"])
def test_a_pipe_or_device_is_refused_at_once(command: str, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    out = ["--out", str(tmp_path / "out")] if command == "import" else []
    for file in (str(pipe), "/dev/zero"):
        done = run(command, file, *out, env={})
        assert done.returncode == 3 and "a pipe or device, not a file" in done.stderr


@contextmanager
def files_of_at_most(n_bytes: int) -> Iterator[None]:
    """A write beyond that fails, as on a full disk: the system says so to whoever writes."""
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, usual[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)


def content(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


@pytest.fixture(scope="module")
def validated(job: Path) -> Path:
    done = spring("validate", job / "c", "--recording", job / "rec")
    assert done.returncode == 0, done.stderr
    return job


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "arguments",
    [
        ["train", "rec", "--model", "hammerstein", "--out", "model.spm"],
        ["emit", "--scene", "scene.toml", "--out", "c"],
        ["validate", "c", "--recording", "rec"],
        ["report", "c"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_nothing_is_left_and_what_was_there_stands(
    arguments: list[str], validated: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(validated, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    before = content(tmp_path)
    with files_of_at_most(1000):
        done = spring(*arguments)
    status, told = (2, "choose another ")
    if arguments[0] == "validate":  # its figures are printed all the same
        status, told = (0, "is not stored for `springpot report`")
    assert done.returncode == status and told in done.stderr.splitlines()[-1], done.stderr
    assert content(tmp_path) == before


def test_every_option_says_in_a_sentence_what_it_does() -> None:
    """Options of settings take it from the docstring that lists them."""
    with click.Context(command_line) as context:
        options = [
            option
            for name in command_line.list_commands(context)
            if (command := command_line.get_command(context, name))
            for option in command.params
            if isinstance(option, click.Option) and not option.hidden
        ]
    said = {option.opts[0]: option.help or "" for option in options}
    assert len(said) > 40
    for name, text in said.items():
        assert re.fullmatch(r"[^>]*\.( .*)?", text, re.S) and len(text) < 250, (name, text)
    assert said["--leaf"] == "How many rows the smallest leaf of a tree holds."
    assert said["--force-delay-s"] == said["--position-delay-s"]
