"""Every remedy that is printed for a faulty file, followed to its end: there the force is right."""

import re
import shlex
import tomllib
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.files.mistakes import Columns, mistaken
from support.files.recording_files import motion, pressed_object
from support.in_process import spring
from support.paths import ROOT

from springpot.trainer.recordings.recording_file import read_recordings

TABLE = tomllib.loads((ROOT / "tests/data/mistakes.toml").read_text("utf-8"))
MISTAKES = TABLE["factors"] | TABLE["faults"]
LIMIT = 0.03  # of the peak force
GEL = {"stroke_mm": 9.0, "peak_n": 8.0, "noise_n": 0.01, "air_mm": 1.0}
PRESSED = {**GEL, "air_mm": -4.0}  # the tool never leaves it
AUTO, TARE = ("--contact-force", "auto"), ("--tare", "auto")
MASS_KG, LATE_S = 5.0, 0.03
NAMES = ("time_s", "position_mm", "force_N")


def changed(channel: int, change: Callable[..., Any]) -> Callable[[Columns], Columns]:
    """A fault of one column, a function of time, the column, and whether a row is one in 97."""

    def fault(c: Columns) -> Columns:
        new = change(c[0], c[channel], np.arange(len(c[0])) % 97 == 50)
        return tuple(new if k == channel else c[k] for k in range(3))  # type: ignore[return-value]

    return fault


FURTHER = {
    "right": changed(2, lambda t, f, at: f),
    "drift": changed(2, lambda t, f, at: f + 0.3 + 0.1 * t),
    "tare": changed(2, lambda t, f, at: f - 0.5),
    "load": changed(2, lambda t, f, at: f + 3.0),
    "hum": changed(2, lambda t, f, at: f + 1.5 * np.sin(2.0 * np.pi * 50.0 * t)),
    "late": changed(2, lambda t, f, at: np.interp(t - LATE_S, t, f)),
    "empty": changed(2, lambda t, f, at: np.where(at, np.nan, f)),
    "spikes": changed(2, lambda t, f, at: np.where(at, 20.0, f)),
    "glitch": changed(2, lambda t, f, at: np.append(50.0, f[1:])),
    "jump": changed(1, lambda t, x, at: np.append(80.0, x[1:])),
    "off": changed(1, lambda t, x, at: x + 5.0),
    "jitter": changed(0, lambda t, _, at: t + 1.5e-3 * np.sin(37.0 * np.arange(len(t)))),
    "mass": lambda c: (
        *c[:2],
        c[2] + MASS_KG * np.gradient(np.gradient(1e-3 * c[1], c[0]), c[0]),
    ),
    "zeroed": changed(2, lambda t, f, at: f - f[0]),
    "gaps": lambda c: tuple(each[np.arange(len(c[0])) % 97 != 50] for each in c),
}
# Words of a remedy that asks for what no file shows, and mistakes that it is not the remedy of.
NOT_FOR = {
    "if the header is right": ".",
    "--accept-signs takes it so": ".",
    "right columns": "late|filtered|dead",
    "SECONDS": "swapped",
}
AT_THE_RIG = "record again|sensor.s cable|finer sensor|higher rate|against the rig|press more"
VALUE = r"'[^']*'|auto|first|min|-?[A-Z_]+|-?[\d.]+|[a-z]+=[^\s,;)]+(?:,[a-z]+=[^\s,;)]+)*"
OPTION = re.compile(rf"--[a-z-]+[ =](?:{VALUE})(?: --align)?(?![\w.])")
IN_PLACE_OF = {"--zero": ("--contact-force", "--tare"), "--tare": ("--contact-force", "--tare")}


class Press:
    """A file with a fault, and what a person who has the rig knows of it."""

    def __init__(self, mistake: str, facts: dict[str, Any], folder: Path) -> None:
        self.mistake, self.facts, self.folder = mistake, facts, folder
        air_m, stroke_m = 1e-3 * facts.get("air_mm", 0.0), 1e-3 * facts["stroke_mm"]
        position_m = motion("cycles", stroke_m + air_m, 200.0, 10.0) - air_m
        self.object = pressed_object(facts)
        force_n = self.object.force(position_m, 5e-3)
        self.clean = 5e-3 * np.arange(2000), 1e3 * position_m, force_n
        if not air_m:
            text = mistaken(facts, mistake, MISTAKES[mistake])
            rows = [line.split(",") for line in text.splitlines()[1:]]
            self.columns: Columns = tuple(np.array(rows, dtype=float).T)  # type: ignore[assignment]
        else:
            noise_n = np.random.default_rng(1).normal(0.0, facts["noise_n"], len(force_n))
            self.columns = FURTHER[mistake]((*self.clean[:2], force_n + noise_n))
        self.tries = 0

    def known(self, option: str) -> str:
        """The option with what a person knows for what stands for it."""
        channel = re.match("time|position|force", option.partition(" ")[2])
        factor = 1.0 / MISTAKES.get(self.mistake, {}).get(channel and channel[0], 1.0)
        late_s = LATE_S if self.facts is GEL else 0.04
        known = {"FACTOR": f"{factor:.9g}", "RATEHz": "200Hz", "KG": f"{MASS_KG}",
                 "SECONDS": f"{late_s}", "PRELOAD_N": f"{self.clean[2][0]}"}  # fmt: skip
        for name, value in known.items():
            option = option.replace(name, value)
        return option

    def remedies(self, line: str, c: Columns) -> Iterator[tuple[Columns, str]]:
        """Columns as a person has mended them in the source, and an option."""
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
                yield tuple(each[np.argsort(c[0])] for each in c), ""  # type: ignore[misc]
            if "unwrap it" in words:
                span_mm = 0.6 * self.facts["stroke_mm"]
                yield (c[0], np.unwrap(c[1], period=span_mm), c[2]), ""
            if "filter it out" in words:
                yield (c[0], c[1], np.convolve(c[2], np.full(4, 0.25), "same")), ""
            if "import the parts" in words and "(1 row in all)" in line:
                self.import_parts(c, int(line.partition(", row ")[2].partition(":")[0]) - 2)

    def import_parts(self, c: Columns, row: int) -> None:
        """Both parts are imported, and are as they were recorded."""
        for part in (slice(0, row), slice(row + 1, None)):
            columns = tuple(each[part] for each in c)
            out = self.imported(columns, ())[1]
            (found,) = read_recordings([out])
            rows = np.searchsorted(self.clean[0], columns[0] - 1e-6)
            off_n = found.force_n - self.clean[2][rows[: len(found.force_n)]]
            assert np.sqrt(np.mean(off_n**2)) < LIMIT * self.facts["peak_n"]

    def imported(self, columns: Columns, options: tuple[str, ...]) -> tuple[Any, Path]:
        self.tries += 1
        file, out = self.folder / "press.csv", self.folder / f"out{self.tries}"
        np.savetxt(file, np.stack(columns, 1), "%.9g", ",", header=",".join(NAMES), comments="")
        return spring("import", file, *options, "--out", out), out

    def error(self, out: Path) -> float:
        """RMS of the force along the motion, averaged over a period of the mains, of the peak."""
        (found,) = read_recordings([out])
        off_n = found.force_n - self.object.force(found.position_m, found.dt_s)
        if self.facts is PRESSED:
            off_n = found.force_n + found.details.get("zero_force_n", 0.0) - self.clean[2]
        averaged_n = np.convolve(off_n, np.full(4, 0.25), "valid")
        return float(np.sqrt(np.mean(averaged_n**2))) / float(self.facts["peak_n"])

    def follow(self, columns: Columns, options: tuple[str, ...], causes: tuple[str, ...]) -> None:
        """Import, and follow what is printed; a cause is never met twice."""
        found, out = self.imported(columns, options)
        where = f"{self.mistake}: {' '.join(options)}, after {causes}: {found.stderr}"
        assert found.returncode in (0, 3), where
        lines = [each for each in found.stderr.splitlines()
                 if re.match("springpot: |warning: ", each)]  # fmt: skip
        met = [re.sub(r"[-+.\d]+", "#", line.split(": ", 2)[2])[:30] for line in lines]
        if causes and not found.returncode and not set(met) - set(causes):
            assert self.error(out) < LIMIT, f"{self.error(out):.3f} {where}"
        for cause, line in zip(met, lines, strict=True):
            ways = list(self.remedies(line, columns))
            assert ways or _at_the_rig(line) or "the parts" in line, where
            assert cause not in causes or not found.returncode, where
            for mended, option in ways if cause not in causes else ():
                added = tuple(shlex.split(option.replace("--tare=", "--tare ")))
                gone = IN_PLACE_OF.get(added[0], added[:1]) if added else ()
                kept = [pair for pair in _pairs(options) if pair[0] not in gone]
                whole = (*(word for pair in kept for word in pair), *added)
                self.follow(mended, whole, (*causes, cause))


def _at_the_rig(line: str) -> bool:
    return bool(re.search(AT_THE_RIG, line))


def _pairs(options: tuple[str, ...]) -> list[tuple[str, ...]]:
    starts = [k for k, word in enumerate(options) if word.startswith("--")]
    return [options[a:b] for a, b in pairwise([*starts, len(options)])]


REFUSED = [(name, each) for part in TABLE["cases"] for each in part["mistakes"]
           for name in part["objects"] if f"{each}, {name}" not in TABLE["silent"]]  # fmt: skip


@pytest.mark.few(30)
@pytest.mark.parametrize(("name", "mistake"), REFUSED, ids=lambda part: part)
def test_remedies_of_mistakes(name: str, mistake: str, tmp_path: Path) -> None:
    press = Press(mistake, TABLE["objects"][name], tmp_path)
    press.follow(press.columns, (), ())


@pytest.mark.parametrize("options", [(), AUTO, TARE], ids=" ".join)
@pytest.mark.parametrize("mistake", FURTHER)
def test_remedies_of_further_faults(mistake: str, options: Any, tmp_path: Path) -> None:
    press = Press(mistake, GEL, tmp_path)
    press.follow(press.columns, options, ())


@pytest.mark.parametrize("options", [(), AUTO, TARE], ids=" ".join)
@pytest.mark.parametrize("mistake", ["right", "zeroed", "empty"])
def test_remedies_under_a_preload(mistake: str, options: Any, tmp_path: Path) -> None:
    press = Press(mistake, PRESSED, tmp_path)
    press.follow(press.columns, options, ())
    assert press.tries > 1 or not options
