"""What an import advises ends: who does as each line says is never sent round in a circle."""

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from support.files.recording_files import write_table
from support.in_process import spring
from support.paths import ROOT

LAYOUTS = tomllib.loads((ROOT / "tests/data/real.toml").read_text("utf-8"))["layout"]
ROUNDS = 4
ADVISED = {
    "--map": r"--map ('[^']*'|[^'\s]+=\S+)", "--zero": r"--zero (first|min)",
    "--contact-force": r"--contact-force (auto)", "--tare": r"--tare (auto)",
    "--resample-hz": r"--resample-hz ([\d.e+]+)", "--force-delay-s": r"--force-delay-s ([\d.e-]+)",
    "--decimal": r"--decimal (comma|point)",
}  # fmt: skip
CHANNEL = re.compile(r",(?=\s*(?:time|position|force)\s*=)")
DONE_BY_ZERO = ("--contact-force", "--tare")


def advised(told: str) -> dict[str, str]:
    """Options with values that may be typed as they stand, not what only a person knows."""
    found: dict[str, str] = {}
    for line in told.splitlines():
        for option, form in ADVISED.items():
            if (match := re.search(form, line)) and "if it was pressed" not in line:
                value = shlex.split(match[1].rstrip(",;:"))[0]
                if not re.search("COL|UNIT|RATE|FACTOR", value):
                    found.setdefault(option, value)
    return found


def merged(before: str, more: str) -> str:
    """A map with channels of another in the place of its own."""
    channels = [part.split("=", 1) for text in (before, more) for part in CHANNEL.split(text)]
    return ",".join(f"{name}={column}" for name, column in dict(channels).items())


def follow(file: Path, options: tuple[str, ...], out: Path) -> None:
    """Import a file, do what is advised, and again, until nothing is."""
    typed: dict[str, str] = {}
    for number in range(ROUNDS + 1):
        more = [word for pair in typed.items() for word in pair]
        more += ["--align"] if "--force-delay-s" in typed else []
        done = spring("import", file, *options, *more, "--out", out / f"{number}")
        told = done.stderr
        if done.returncode == 0:
            told += "\n" + spring("check", out / f"{number}").stdout
        assert not (number and done.returncode == 2), (typed, told)
        now = advised(told)
        assert not {option for option, value in now.items() if typed.get(option) == value}, told
        if not now:
            return
        if "--map" in now and "--map" in typed:
            now["--map"] = merged(typed["--map"], now["--map"])
        gone = DONE_BY_ZERO if "--zero" in now else ("--zero",) if {*now} & {*DONE_BY_ZERO} else ()
        typed = {option: value for option, value in {**typed, **now}.items() if option not in gone}
    pytest.fail(f"advised after {ROUNDS} rounds: {typed}")


@pytest.mark.slow
@pytest.mark.parametrize("facts", LAYOUTS, ids=lambda facts: facts["name"])
def test_advice_on_a_public_layout_ends(facts: dict[str, str], tmp_path: Path) -> None:
    write_table(tmp_path / "press.csv", facts)
    follow(tmp_path / "press.csv", tuple(shlex.split(facts.get("options", ""))), tmp_path)
