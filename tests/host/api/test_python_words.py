"""What Python's calls say: arguments in Python's words, files in one line, recordings kept."""

import ast
import inspect
import logging
import os
from pathlib import Path

import pytest
from support.messages import refusing
from support.pages.sources import FLOORS
from support.paths import ROOT
from support.small import passive_model, training

import springpot
from springpot.codegen import errors
from springpot.codegen.errors import DataError, SpringpotError, UsageError, in_python
from springpot.host.bench import bench as bench_module
from springpot.host.validation.validation import validate
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.importing import ImportOptions

# What a command prints, and no call of Python.
COMMANDS = (
    *("host/commands/", "host/native/", "host/pages/", "host/emission/b", "host/cli.py"),
    *("host/options.py", "host/output.py", "codegen/errors.py", "codegen/native/"),
)


@pytest.fixture(autouse=True)
def in_no_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SpringpotError, "in_command", False)


def messages(file: Path) -> list[str]:
    """Texts of a file, each a whole string with its formatted parts as `x`; no docstrings."""
    tree = ast.parse(file.read_text("utf-8"))
    apart = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    joined = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]
    texts = ["".join(part.value if isinstance(part, ast.Constant) else "x" for part in node.values)
             for node in joined]  # fmt: skip
    apart |= {id(part) for node in joined for part in node.values}
    return texts + [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in apart
    ]


def test_every_option_of_a_message_is_an_argument_of_python() -> None:
    calls = [getattr(springpot, name) for name in dir(springpot)]
    calls += [Conditioning, ImportOptions, springpot.Recording.from_frame, validate]
    known = {
        name for call in calls if not isinstance(call, type) or not issubclass(call, Exception)
        for name in inspect.signature(call).parameters
    }  # fmt: skip
    seen = set()
    for file in (file for floor in FLOORS for file in (ROOT / floor).rglob("*.py")):
        if str(file.relative_to(ROOT)).startswith(COMMANDS):
            continue
        for text in messages(file):
            for found in errors._OPTION.finditer(text):
                said = errors._argument(found)
                seen.add(said)
                name = said.partition("=")[0]
                assert name in known or said.endswith(" on the command line"), (file, text, said)
    assert len(seen) > 40


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pass --map force=COL:-1N, and train", 'pass columns="force=COL:-1N", and train'),
        ("with --force-delay-s 0.02 --align", "with force_delay_s=0.02 align=True"),
        ("--zero first or --zero min", 'zero="first" or zero="min"'),
        ("without --contact-force and --tare if", "without contact_force and tare if"),
        ("with --tare=-PRELOAD_N, or --tare 0", "with tare=-PRELOAD_N, or tare=0"),
        ("try --model rf-fd", 'try kind="rf-fd"'),
        ("`springpot emit --out` makes one", "springpot.emit() makes one"),
        ("run `springpot check`", "run springpot.check_recordings()"),
        ("a sensor, --force URL", "a sensor, --force URL on the command line"),
    ],
)
def test_options_in_python_s_words(text: str, said: str) -> None:
    assert in_python(text) == said
    SpringpotError.in_command = True
    assert in_python(text) == text == str(UsageError(text))


def test_a_call_names_its_arguments(recwarn: pytest.WarningsRecorder) -> None:
    with refusing(UsageError, 'select="paper" chooses orders', "give validation"):
        springpot.train(training(), "rbf-fd", select="paper")
    pulled = [springpot.Recording(one.name, one.position_m, -one.force_n, one.dt_s)
              for one in training()]  # fmt: skip
    with refusing(DataError, "columns="):
        springpot.train(pulled)
    assert not [one for one in recwarn if "--" in str(one.message)]


def test_the_same_recordings_are_read_and_others_are_not_overwritten(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "springpot")
    protocol = tmp_path / "short.toml"
    protocol.write_text("[[profile]]\namplitude_n = 2\nfrequency_hz = 5\n" * 2)
    pad, out = "sim://ecoflex-00-30", tmp_path / "presses"
    first = springpot.record(pad, protocol, out, seed=1)
    assert not caplog.text
    again = springpot.record(pad, protocol, out, seed=1)
    assert [one.content_hash for one in again] == [one.content_hash for one in first]
    assert "read, and nothing is pressed" in caplog.text
    kept = sorted(out.iterdir())
    for url, seed in ((pad, 2), (f"{pad}?variant=a", 1)):
        with refusing(UsageError, str(kept[0]), "with other settings", "give another folder"):
            springpot.record(url, protocol, out, seed=seed)
    kept[1].unlink()
    with refusing(UsageError, "without the others of this protocol"):
        springpot.record(pad, protocol, out, seed=1)
    assert sorted(out.iterdir()) == kept[:1]


@pytest.mark.parametrize("place", ["file", "closed"])
def test_where_nothing_can_be_written_a_call_says_so_in_a_line(tmp_path: Path, place: str) -> None:
    where = tmp_path / place
    if place == "file":
        where.write_text("in the way")
    else:
        where.mkdir(mode=0o500)
        if os.access(where, os.W_OK):
            where = Path("/proc/none")  # for who may write everywhere
    fit = passive_model()
    for call in (
        lambda: springpot.write_model(where / "a" / "m.spm", fit),
        lambda: springpot.write_recordings(where / "a", training()),
        lambda: springpot.write_recordings(where / "a.h5", training()[0]),
        lambda: springpot.emit(where / "c", model=fit),
        lambda: springpot.record("sim://ecoflex-00-30", "paper", where / "presses"),
    ):
        with refusing(UsageError, str(where), ": "):
            call()


def test_names_of_files_stay_as_they_are() -> None:
    text = "press--late.csv, rig/--align.csv: bad: pass --zero first, or (--align)"
    said = 'press--late.csv, rig/--align.csv: bad: pass zero="first", or (align=True)'
    assert str(DataError(text)) == said


def test_what_a_bench_could_not_make_is_told_in_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = [{"model": "rbf-fd", "error": "too short: give --window-s 0.1"}]
    monkeypatch.setattr(bench_module, "run_bench", lambda *_: {"refused": refused, "seed": 0})
    told = springpot.bench(training(), validation=training()[:1])
    assert told["refused"][0]["error"] == "too short: give window_s=0.1"
