"""A scene in one file: it compiles anywhere without a warning, and gives the same bits."""

import re
import shutil
import subprocess
from collections.abc import Sequence
from itertools import cycle
from pathlib import Path

import pytest
from support.c import golden_forces
from support.c.single import every_plan, plan_of, write_single

from springpot.codegen.plan import Plan, list_headers
from springpot.runtime_c.paths import SOURCE

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
LANGUAGES = (
    ("gcc", "-std=c11", ".c"),
    ("clang", "-std=c11", ".c"),
    ("g++", "-std=c++17", ".cpp"),
    ("clang++", "-std=c++17", ".cpp"),
)
LEVELS = ("-Os", "-O0", "-O2", "-O1", "-O3")
FOUND = [language for language in LANGUAGES if shutil.which(language[0])]
CPU_FLAGS = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
FMA = pytest.mark.skipif("fma" not in CPU_FLAGS, reason="this processor has no fused multiply-add")
MAIN = '#include "@.h"\nint main(void) { return @_selftest() ? 3 : 0; }\n'


def hammerstein() -> Plan:
    return plan_of("soft", golden_forces.model("hammerstein"), "float32", "tool")


def radial() -> Plan:
    return plan_of("hard", golden_forces.model("rbf-pv"), "float64", "proxy")


def compiled(out: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [*map(str, arguments), "-o", str(out), *(() if "-c" in arguments else ("-lm",))]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def passes(folder: Path, source: Path, *command: str) -> bool:
    """Whether the self-test of a source passes, built by a command."""
    main = folder / f"main{source.suffix}"
    main.write_text(MAIN.replace("@", source.stem))
    done = compiled(folder / "main", *command, main, source)
    assert done.returncode == 0, done.stderr
    ended = subprocess.run([folder / "main"], check=False).returncode
    assert ended in (0, 3)
    return ended == 0


def require_clean(
    plan: Plan, folder: Path, level: str, languages: Sequence[tuple[str, str, str]]
) -> None:
    """No warning in those languages, and a self-test that passes."""
    source = write_single(plan, folder)
    for compiler, standard, suffix in languages:
        options = (compiler, standard, level, *WARNINGS)
        assert passes(folder, source.with_suffix(suffix), *options), (plan.scene.name, compiler)


def test_no_warning_in_c_and_cpp(tmp_path: Path) -> None:
    require_clean(hammerstein(), tmp_path, "-O0", FOUND)


@pytest.mark.parametrize("language", FOUND, ids=lambda language: language[0])
def test_two_scenes_compile_in_one_unit(tmp_path: Path, language: tuple[str, str, str]) -> None:
    """As a game's build does that joins its sources: of two number types, with a forest."""
    compiler, standard, suffix = language
    forest = plan_of("tree", golden_forces.model("rf-fd"), "float32", "off")
    plans = (hammerstein(), radial(), forest)
    for plan in plans:
        write_single(plan, tmp_path)
    names = [plan.scene.runtime.prefix for plan in plans]
    unit = tmp_path / f"unit{suffix}"
    unit.write_text(
        "".join(f'#include "{name}.c"\n' for name in names)
        + f"int main(void) {{ return {' + '.join(f'{name}_selftest()' for name in names)}; }}\n"
    )
    done = compiled(tmp_path / "unit", compiler, standard, "-O1", *WARNINGS, "-Wshadow", unit)
    assert done.returncode == 0, done.stderr
    for other in ("c11", "c17") if suffix == ".c" else ("c++11", "c++14", "c++20"):
        options = (f"-std={other}", "-fsyntax-only", "-c", *WARNINGS, "-Wshadow")
        done = compiled(tmp_path / "x.o", compiler, *options, unit)
        assert (done.returncode, done.stderr) == (0, ""), other
    assert subprocess.run([tmp_path / "unit"], check=False).returncode == 0


@pytest.mark.slow
def test_no_warning_for_any_kind_at_any_level(tmp_path: Path) -> None:
    """Levels and pairs of compilers take turns."""
    units: set[str] = set()
    turns = zip(cycle(LEVELS), cycle((FOUND[::3], FOUND[1:3])), strict=False)
    for plan, (level, languages) in zip(every_plan("host"), turns, strict=False):
        units.update(list_headers(plan))
        require_clean(plan, tmp_path / plan.scene.name, level, languages)
    assert units == {file.name for file in SOURCE.glob("*.h")}


def test_only_the_api_is_public_and_nothing_changes(tmp_path: Path) -> None:
    source = write_single(radial(), tmp_path)
    for compiler, _, suffix in FOUND:
        built = tmp_path / "x.o"
        assert compiled(built, compiler, "-O2", "-c", source.with_suffix(suffix)).returncode == 0
        said = subprocess.run(["nm", built], capture_output=True, text=True, check=True).stdout
        rows = [line.split()[-2:] for line in said.splitlines()]
        header = source.with_suffix(".h").read_text()
        declared = set(re.findall(r"\b(hard_\w+)\(", header.partition("static inline")[0]))
        assert {name for kind, name in rows if kind == "T"} == declared
        assert not [name for kind, name in rows if kind in "BbDdC"]


@FMA
@pytest.mark.parametrize("language", FOUND, ids=lambda language: language[0])
def test_no_flag_of_ours_is_needed(tmp_path: Path, language: tuple[str, str, str]) -> None:
    """Compilers contract by default: without its pragmas the self-test would fail."""
    compiler, _, suffix = language
    source = write_single(hammerstein(), tmp_path).with_suffix(suffix)
    options = (compiler, "-O2", "-march=haswell")
    assert passes(tmp_path, source, *options)
    assert passes(tmp_path, source, compiler, "-Os", "-march=haswell", "-flto")
    text, removed = re.subn(r"#pragma (STDC|GCC (optimize|push|pop)).*\n", "", source.read_text())
    assert removed == 5
    source.write_text(text)
    contracts = () if "clang" in compiler else ("-ffp-contract=fast",)
    assert not passes(tmp_path, source, *options, *contracts)


@FMA
@pytest.mark.skipif(shutil.which("clang") is None, reason="no clang")
def test_the_selftest_sees_what_pragmas_cannot_stop(tmp_path: Path) -> None:
    source = write_single(hammerstein(), tmp_path)
    assert not passes(tmp_path, source, "clang", "-O2", "-mfma", "-ffp-contract=fast")
    sums = ("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math")
    assert not passes(tmp_path, source, "gcc", "-O2", *sums)


@pytest.mark.parametrize("language", FOUND, ids=lambda language: language[0])
def test_fast_math_does_not_compile(tmp_path: Path, language: tuple[str, str, str]) -> None:
    compiler, _, suffix = language
    source = write_single(hammerstein(), tmp_path).with_suffix(suffix)
    for fast in ("-Ofast", "-D_M_FP_FAST"):  # as Visual Studio's /fp:fast says it
        done = compiled(tmp_path / "x.o", compiler, fast, "-c", source)
        assert done.returncode != 0 and "without -ffast-math" in done.stderr


def test_no_line_is_wider_than_a_screen_shows(tmp_path: Path) -> None:
    for plan in (hammerstein(), radial()):
        source = write_single(plan, tmp_path)
        lines = [*source.read_text().split("\n"), *source.with_suffix(".h").read_text().split("\n")]
        code = [line for line in lines if not line.lstrip().startswith(("*", "/*", 'return "{'))]
        assert [line for line in code if len(line) > 100] == []
