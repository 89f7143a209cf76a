"""Mislabelled files: each is refused, warned of by its cause, or makes next to no difference.

Every remedy that is printed for one, followed to its end: there the force is right. Layouts of
public recordings: each imported as it is meant, or refused with what to do.
"""

import json
import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.files.mistakes import FAULTS, mistaken
from support.files.recording_files import motion, pressed_object, write_table
from support.in_process import spring
from support.paths import ROOT

from springpot.trainer.recordings.recording_file import read_recordings

TABLE = tomllib.loads((ROOT / "tests/data/mistakes.toml").read_text("utf-8"))
MISTAKES: dict[str, dict[str, Any]] = TABLE["factors"] | TABLE["faults"]
LIMIT = 0.1  # of the peak force
CASES = [(mistake, name) for part in TABLE["cases"] for mistake in part["mistakes"]
         for name in part["objects"]]  # fmt: skip


def error(folder: Path, facts: dict[str, Any]) -> float:
    """Error of the recorded force along the recorded motion, rms over the peak of either."""
    (recording,) = read_recordings([folder])
    true_n = pressed_object(facts).force(recording.position_m, recording.dt_s)
    peak_n = max(float(np.abs(recording.force_n).max()), float(true_n.max()))
    return float(np.sqrt(np.mean((recording.force_n - true_n) ** 2))) / peak_n


@pytest.mark.few(59)
@pytest.mark.parametrize(("mistake", "name"), CASES, ids=lambda part: part)
def test_mistake(mistake: str, name: str, tmp_path: Path) -> None:
    facts, stated = TABLE["objects"][name], MISTAKES[mistake]
    file = tmp_path / "press.csv"
    file.write_text(mistaken(facts, mistake, stated))
    found = spring("import", file, "--out", tmp_path / "out")
    # What was understood of the header, and the names of folders, name no cause.
    said = (found.stdout + found.stderr).replace(str(tmp_path), "").splitlines()
    lines = [line for line in said if "numbers from row" not in line]
    named = any(word in line for word in stated["names"] for line in lines)
    wrong = found.returncode == 0 and not named and error(tmp_path / "out", facts) > LIMIT
    assert found.returncode in (0, 3)
    assert wrong == (f"{mistake}, {name}" in TABLE["silent"]), found.stdout + found.stderr


MENDED = 0.03  # of the peak force
GEL = {"stroke_mm": 9.0, "peak_n": 8.0, "noise_n": 0.01, "air_mm": 1.0}
PRESSED = {**GEL, "air_mm": -4.0}  # the tool never leaves it
AUTO, TARE = "--contact-force auto", "--tare auto"
MASS_KG = 5.0
FAULTS_HERE = FAULTS | {
    "right": lambda c: c,
    "strong hum": lambda c: (*c[:2], c[2] + 1.5 * np.sin(2.0 * np.pi * 50.0 * c[0])),
    "heavy": lambda c: (*c[:2], c[2] + MASS_KG * np.gradient(np.gradient(1e-3 * c[1], c[0]), c[0])),
    "empty": lambda c: (*c[:2], np.where(np.arange(len(c[0])) % 97 == 50, np.nan, c[2])),
    "glitch": lambda c: (c[0], np.append(80.0, c[1][1:]), np.append(50.0, c[2][1:])),
    "jitter": lambda c: (c[0] + 1.5e-3 * np.sin(37.0 * np.arange(len(c[0]))), *c[1:]),
    "gaps": lambda c: tuple(each[np.arange(len(c[0])) % 97 != 50] for each in c),
    "zeroed": lambda c: (*c[:2], c[2] - c[2][0]),
}
# Words of a remedy that is of other mistakes than these: a person knows what the file does not say.
NOT_FOR = {
    "if the header is right": ".",
    "--accept-signs takes it so": ".",
    "right columns": "late|filtered|dead",
    "SECONDS": "swapped",
    "if the object pushes so there": ".",
}
AT_THE_RIG = "record again|sensor.s cable|finer sensor|higher rate|against the rig|press more"
VALUE = r"'[^']*'|auto|first|min|-?[A-Z_]+|-?[\d.]+|[a-z]+=[^\s,;)]+(?:,[a-z]+=[^\s,;)]+)*"
OPTION = re.compile(rf"--[a-z-]+[ =](?:{VALUE})(?: --align)?(?![\w.])")


class Press:
    """A file with a mistake, and what a person who has the rig knows of it."""

    def __init__(self, mistake: str, facts: dict[str, Any], folder: Path) -> None:
        self.mistake, self.facts, self.folder, self.tries = mistake, facts, folder, 0
        air_m = 1e-3 * facts.get("air_mm", 0.0)
        self.travel_mm = facts["stroke_mm"] + 1e3 * air_m
        position_m = motion("cycles", 1e-3 * self.travel_mm, 200.0, 10.0) - air_m
        self.object = pressed_object(facts)
        self.force_n = self.object.force(position_m, 5e-3)
        if air_m:
            noise_n = np.random.default_rng(1).normal(0.0, facts["noise_n"], 2000)
            clean = 5e-3 * np.arange(2000), 1e3 * position_m, self.force_n + noise_n
            self.columns = np.array(FAULTS_HERE[mistake](clean))
        else:
            text = mistaken(facts, mistake, MISTAKES[mistake])
            self.columns = np.loadtxt(text.splitlines()[1:], delimiter=",").T

    def known(self, option: str) -> str:
        """The option with what a person knows in place of what stands for it."""
        channel = re.match("time|position|force", option.partition(" ")[2])
        factor = 1.0 / MISTAKES.get(self.mistake, {}).get(channel and channel[0], 1.0)
        known = {"FACTOR": f"{factor:.9g}", "RATEHz": "200Hz", "KG": f"{MASS_KG}",
                 "SECONDS": "0.04", "PRELOAD_N": f"{self.force_n[0]}"}  # fmt: skip
        for name, value in known.items():
            option = option.replace(name, value)
        return option.replace("--tare=", "--tare ")

    def remedies(self, line: str, c: Any) -> Iterator[tuple[Any, str]]:
        """Columns as a person has mended them in the source, and options."""
        for words in re.split(r"(?:; |, or |, else | or (?=--)|: (?=[a-z-]))", line):
            if any(key in words and re.search(no, self.mistake) for key, no in NOT_FOR.items()):
                continue
            for option in OPTION.findall(words):
                yield c, self.known(option)
            if "import without" in words or "leave --contact-force out" in words:
                yield c, "--zero none"
            if "right columns" in words:
                yield c, "--map time=time_s:s,position=force_N:mm,force=position_mm:N"
            if "sort the rows" in words:
                yield c[:, np.argsort(c[0])], ""
            if "unwrap it" in words:
                yield (c[0], np.unwrap(c[1], period=0.6 * self.travel_mm), c[2]), ""
            if "filter it out" in words:
                yield (*c[:2], np.convolve(c[2], np.full(4, 0.25), "same")), ""
            if "import the parts" in words and "(1 row in all)" in line:
                row = int(line.partition(", row ")[2].partition(":")[0]) - 2
                for part in (c[:, :row], c[:, row + 1 :]):
                    (found,) = read_recordings([self.imported(part, "")[1]])
                    true_n = self.force_n[
                        np.round(200.0 * part[0, : len(found.force_n)]).astype(int)
                    ]
                    assert np.abs(found.force_n - true_n).max() < MENDED * self.facts["peak_n"]

    def imported(self, columns: Any, options: str) -> tuple[Any, Path]:
        self.tries += 1
        file, out = self.folder / "press.csv", self.folder / f"out{self.tries}"
        names = "time_s,position_mm,force_N"
        np.savetxt(file, np.stack(columns, 1), "%.9g", ",", header=names, comments="")
        return spring("import", file, *shlex.split(options), "--out", out), out

    def error(self, out: Path) -> float:
        """RMS of the force along the motion, averaged over a period of the mains, of the peak."""
        (found,) = read_recordings([out])
        off_n = found.force_n - self.object.force(found.position_m, found.dt_s)
        if self.facts is PRESSED:
            off_n = found.force_n + found.details.get("zero_force_n", 0.0) - self.force_n
        averaged_n = np.convolve(off_n, np.full(4, 0.25), "valid")
        return float(np.sqrt(np.mean(averaged_n**2))) / float(self.facts["peak_n"])

    def follow(self, columns: Any, options: str = "", causes: tuple[str, ...] = ()) -> None:
        """Import, and follow what is printed; a cause is never met twice."""
        found, out = self.imported(columns, options)
        where = f"{self.mistake}: {options}, after {causes}: {found.stderr}"
        assert found.returncode in (0, 3), where
        lines = re.findall("^(?:springpot|warning): .*", found.stderr, re.MULTILINE)
        met = [re.sub(r"[-+.\d]+", "#", line.split(": ", 2)[2])[:30] for line in lines]
        if causes and not found.returncode and not set(met) - set(causes):
            assert self.error(out) < MENDED, f"{self.error(out):.3f} {where}"
        for cause, line in zip(met, lines, strict=True):
            ways = list(self.remedies(line, columns))
            assert ways or re.search(AT_THE_RIG + "|the parts", line), where
            assert cause not in causes or not found.returncode, where
            for mended, option in ways if cause not in causes else ():
                name = option.partition(" ")[0]
                own = name in ("--zero", "--tare")  # in place of what finds a zero
                gone = "--(contact-force|tare|zero) \\S+" if own else f"{name or '-0'} \\S+"
                self.follow(mended, f"{re.sub(gone, '', options)} {option}", (*causes, cause))


REFUSED = [case for case in CASES if ", ".join(case) not in TABLE["silent"]]


@pytest.mark.few(30)
@pytest.mark.parametrize(("mistake", "name"), REFUSED, ids=lambda part: part)
def test_remedies_of_mistakes(mistake: str, name: str, tmp_path: Path) -> None:
    press = Press(mistake, TABLE["objects"][name], tmp_path)
    press.follow(press.columns)


@pytest.mark.few(40)
@pytest.mark.parametrize("options", ["", AUTO, TARE])
@pytest.mark.parametrize("mistake", sorted(FAULTS_HERE.keys() - {"backlash", "compliance"}))
def test_faults_beside_a_choice(mistake: str, options: str, tmp_path: Path) -> None:
    """Follow the remedy of each mistake that is named."""
    press = Press(mistake, GEL, tmp_path)
    press.follow(press.columns, options)


@pytest.mark.parametrize("options", ["", AUTO, TARE])
@pytest.mark.parametrize("mistake", ["right", "zeroed", "empty", "force_spike", "gaps"])
def test_faults_of_a_tool_that_stays_on_the_object(
    mistake: str, options: str, tmp_path: Path
) -> None:
    press = Press(mistake, PRESSED, tmp_path)
    press.follow(press.columns, options)


LAYOUTS = tomllib.loads((ROOT / "tests/data/real.toml").read_text("utf-8"))["layout"]


@pytest.mark.parametrize("facts", LAYOUTS, ids=lambda facts: facts["name"])
def test_layout(facts: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "press.csv"
    write_table(file, facts)
    options = shlex.split(facts.get("options", ""))
    found = spring("import", file, *options, "--out", tmp_path / "out", "--json")
    for words in facts.get("says", []):
        assert words in found.stderr
    if facts.get("expect") == "refused":
        assert found.returncode == 3 and not (tmp_path / "out").exists()
        return
    assert found.returncode == 0, found.stderr
    (row,) = json.loads(found.stdout)["recordings"]
    (low_m, high_m), (_, peak_n) = row["position_m"], row["force_n"]
    assert high_m - low_m == pytest.approx(facts["stroke_mm"] * 1e-3, rel=0.02)
    assert peak_n == pytest.approx(facts["peak_n"], rel=0.02)
    assert row["rate_hz"] == pytest.approx(facts.get("rate_hz", 200.0), rel=0.02)
