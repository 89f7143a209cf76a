"""What an emitted folder is: the same bytes again, warning-clean, nothing unreachable, by hand."""

import json
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from support.small import model_file, scene, small_model

from springpot.codegen.errors import BudgetError, MismatchError, UsageError
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.plan.units import state_bytes
from springpot.codegen.scene import Budget
from springpot.host.emission.emission import emit
from springpot.host.native.footprint import deepest_stack
from springpot.host.native.scene_library import SceneLibrary
from springpot.runtime_c.paths import flags

SHAPES = {
    "plain": scene(),
    "paper": scene(mode="tool", smoothing_s=8.3e-4, number="float64"),
    "prefixed": scene(prefix="eco", mode="tool"),
    "m2cgen": scene(forest="m2cgen"),
}
CPU_FLAGS = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
API = ["abi_version", "state_size", "manifest", "init", "reset", "step", "run", "idle", "selftest"]


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Each shape emitted once, to be read."""

    @cache
    def folder(shape: str) -> Path:
        above = tmp_path_factory.mktemp(shape)
        return emit(SHAPES[shape], model_file(above), above / "c").folder

    return folder


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("shape", list(SHAPES))
def test_generated_c_is_warning_clean(
    tmp_path: Path, folder_of: Callable[[str], Path], shape: str, compiler: str
) -> None:
    sources = sorted(folder_of(shape).glob("*.c"))
    assert len(sources) == 3
    for source in sources:
        command = [compiler, *flags("SP_CFLAGS"), *flags("SP_STRICT"), "-c", str(source), "-o",
                   str(tmp_path / "object.o")]  # fmt: skip
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
        assert result.stderr == ""


@pytest.mark.parametrize("shape", list(SHAPES))
def test_image_holds_the_api_and_nothing_else(
    tmp_path: Path, folder_of: Callable[[str], Path], shape: str
) -> None:
    prefix = SHAPES[shape].runtime.prefix
    symbols = ""
    for part in ("scene", "selftest"):
        built = tmp_path / f"{part}.o"
        source = folder_of(shape) / f"{prefix}_{part}.c"
        subprocess.run(["gcc", *flags("SP_CFLAGS"), "-c", source, "-o", built], check=True)
        symbols += subprocess.run(["nm", built], capture_output=True, text=True, check=True).stdout
    rows = [line.split()[-2:] for line in symbols.splitlines()]
    public = {name for kind, name in rows if kind == "T"}
    assert public == {f"{prefix}_{name}" for name in API}
    # No variable that changes, and nothing from outside but memory copies.
    assert not [name for kind, name in rows if kind in "BbDdC"]
    outside = {name for kind, name in rows if kind == "U"} - public
    # "__cpu_model" is the compiler's own record of the processor.
    assert outside <= {"memset", "memcpy", "_GLOBAL_OFFSET_TABLE_", "__cpu_model"}


@pytest.mark.parametrize("shape", list(SHAPES))
def test_state_is_as_large_as_planned(folder_of: Callable[[str], Path], shape: str) -> None:
    plan = make_plan(small_model(), SHAPES[shape])
    assert SceneLibrary(folder_of(shape)).state_bytes == state_bytes(plan)


def test_builds_by_hand_without_python(tmp_path: Path) -> None:
    emission = emit(SHAPES["plain"], model_file(tmp_path), tmp_path / "c")
    clean = {"PATH": "/usr/bin:/bin", "LC_ALL": "C"}
    subprocess.run(["make", "-C", tmp_path / "c", "test"], env=clean, check=True,
                   capture_output=True)  # fmt: skip
    result = subprocess.run([tmp_path / "c" / "example"], input="0\n0.001\n0.002\n", text=True,
                            capture_output=True, check=True)  # fmt: skip
    assert f'"hash": "{emission.hash}"' in result.stderr
    forces = [float(line.split()[0]) for line in result.stdout.splitlines()]
    state = SceneLibrary(tmp_path / "c").new_state()
    assert forces == pytest.approx([state.step(x)[0] for x in (0.0, 0.001, 0.002)])
    assert forces[0] == 0.0 < forces[2]
    wrong = subprocess.run([tmp_path / "c" / "example"], input="0\nx\n", text=True,
                           capture_output=True, check=False)  # fmt: skip
    assert wrong.returncode == 1
    assert "line 2 is not a number" in wrong.stderr


@pytest.mark.skipif("fma" not in CPU_FLAGS, reason="this processor has no fused multiply-add")
@pytest.mark.parametrize("mode", ["off", "tool"])
def test_selftest_catches_other_floating_point(tmp_path: Path, mode: str) -> None:
    emit(scene(mode=mode), model_file(tmp_path), tmp_path / "c")
    contracted = ["-std=c11", "-O2", "-mfma", "-ffp-contract=fast"]
    for options, passes in ((flags("SP_CFLAGS"), True), (contracted, False)):
        sources = [str(path) for path in sorted((tmp_path / "c").glob("*.c"))]
        program = tmp_path / "program"
        subprocess.run(["gcc", *options, *sources, "-o", program], check=True)
        result = subprocess.run([program], input="", capture_output=True, text=True, check=False)
        assert (result.returncode == 0) is passes
        assert ("self-test passed" if passes else "-ffp-contract=off") in result.stderr


def test_the_selftest_sees_a_compiler_that_assumes_away_nan(tmp_path: Path) -> None:
    """Where a compiler does not say so: its watchdog would never latch."""
    emit(scene(), model_file(tmp_path), tmp_path / "c")
    hidden = ["-ffinite-math-only", "-U__FINITE_MATH_ONLY__"]
    sources = [str(path) for path in sorted((tmp_path / "c").glob("*.c"))]
    for options, passes in (([], True), (hidden, False)):
        program = tmp_path / "program"
        subprocess.run(["gcc", *flags("SP_CFLAGS"), *options, *sources, "-o", program], check=True)
        result = subprocess.run([program], input="", capture_output=True, text=True, check=False)
        assert (result.returncode == 0) is passes


def test_a_library_that_differs_is_not_emitted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SceneLibrary, "selftest", lambda _: 3)
    with pytest.raises(MismatchError, match="golden tick 2"):
        emit(SHAPES["plain"], model_file(tmp_path), tmp_path / "c")
    assert [path.name for path in tmp_path.iterdir()] == ["model.spm"]


def test_two_prefixes_link_into_one_c_and_one_cpp_program(tmp_path: Path) -> None:
    model = model_file(tmp_path)
    emit(scene(prefix="soft"), model, tmp_path / "soft")
    emit(scene(prefix="hard", mode="tool", number="float64"), model, tmp_path / "hard")
    (tmp_path / "main.c").write_text(
        '#include "soft/soft.h"\n#include "hard/hard.h"\n'
        "int main(void) { return soft_selftest() + hard_selftest() + "
        "(soft_state_size() == hard_state_size()); }\n"
    )
    objects = []
    for name in ("soft", "hard"):
        for part in ("scene", "selftest"):
            objects.append(str(tmp_path / f"{name}_{part}.o"))
            source = tmp_path / name / f"{name}_{part}.c"
            command = ["gcc", *flags("SP_CFLAGS"), "-c", str(source), "-o", objects[-1]]
            subprocess.run(command, check=True)
    compilers = [("gcc", "c")] + ([("g++", "c++")] if shutil.which("g++") else [])
    for compiler, language in compilers:
        program = tmp_path / f"main-{language[-1]}"
        command = [compiler, "-x", language, str(tmp_path / "main.c"), "-x", "none", *objects,
                   "-o", str(program)]  # fmt: skip
        subprocess.run(command, check=True)
        assert subprocess.run([program], check=False).returncode == 0


@pytest.mark.parametrize(("stack_bytes", "told"), [(1000, True), (20_000, False), (None, False)])
def test_the_stack_of_the_selftest_is_told(
    tmp_path: Path, stack_bytes: int | None, told: bool
) -> None:
    """A tick fits in the budget, a second state does not."""
    shape = replace(SHAPES["plain"], budget=Budget(stack_bytes=stack_bytes))
    emission = emit(shape, model_file(tmp_path), tmp_path / "c")
    notices = [line for line in emission.notices if "the self-test takes" in line]
    assert bool(notices) is told


@pytest.mark.parametrize(
    ("target", "software"), [("cortex-m4f", True), ("cortex-m7", False), ("wasm32", False)]
)
def test_doubles_in_software_are_told(tmp_path: Path, target: str, software: bool) -> None:
    chosen = scene(number="float64")
    chosen = replace(chosen, runtime=replace(chosen.runtime, target=target))
    notices = emit(chosen, model_file(tmp_path), tmp_path / "c").notices
    assert any("doubles run in software" in notice for notice in notices) == software


def test_left_out_is_told(tmp_path: Path) -> None:
    emission = emit(SHAPES["plain"], model_file(tmp_path), tmp_path / "c")
    told = {item["what"]: item for item in emission.manifest["left_out"]}
    assert {"coupling", "smoothing", "velocity estimate"} <= set(told)
    assert all(item["why"] for item in told.values())
    with_all = state_bytes(make_plan(small_model(), SHAPES["paper"]))
    assert with_all > emission.ram_bytes


def test_emission_replaces_its_own_folder_and_no_other(tmp_path: Path) -> None:
    model = model_file(tmp_path)
    emit(SHAPES["paper"], model, tmp_path / "c")
    emit(SHAPES["plain"], model, tmp_path / "c")
    assert not (tmp_path / "c" / "sp_couple.h").exists()
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="did not emit"):
        emit(SHAPES["plain"], model, mine)
    assert (mine / "thesis.txt").read_text() == "mine"


@pytest.mark.parametrize("name", ["main.c", "mine.c", "from/note.txt"])
def test_emission_never_overwrites_what_a_user_changed(tmp_path: Path, name: str) -> None:
    model = model_file(tmp_path)
    emit(SHAPES["plain"], model, tmp_path / "c")
    (tmp_path / "c" / name).write_text("mine")
    (tmp_path / "c.old").mkdir()
    with pytest.raises(UsageError, match=name):
        emit(SHAPES["plain"], model, tmp_path / "c")
    assert (tmp_path / "c" / name).read_text() == "mine"
    assert (tmp_path / "c.old").exists()


def test_headers_of_two_number_types_do_not_meet_in_one_file(tmp_path: Path) -> None:
    model = model_file(tmp_path)
    emit(scene(prefix="soft"), model, tmp_path / "soft")
    emit(scene(prefix="hard", number="float64"), model, tmp_path / "hard")
    source = tmp_path / "both.c"
    source.write_text('#include "soft/soft_scene.h"\n#include "hard/hard_scene.h"\n')
    result = subprocess.run(["gcc", "-c", source, "-o", tmp_path / "both.o"], capture_output=True,
                            text=True, check=False)  # fmt: skip
    assert result.returncode != 0
    assert "hard_state_is_as_planned" in result.stderr


def test_budget_is_kept(tmp_path: Path) -> None:
    tight = replace(SHAPES["plain"], budget=Budget(flash_bytes=1000))
    with pytest.raises(BudgetError, match="the scene's budget is 1000"):
        emit(tight, model_file(tmp_path), tmp_path / "c")
    assert not (tmp_path / "c").exists()


def test_manifest_says_what_the_image_says(tmp_path: Path) -> None:
    emission = emit(SHAPES["prefixed"], model_file(tmp_path), tmp_path / "c")
    image = SceneLibrary(tmp_path / "c").manifest
    written = json.loads((tmp_path / "c" / "manifest.json").read_text())
    assert image.items() <= written.items()
    assert image["hash"] == emission.hash
    first_line = (tmp_path / "c" / "eco_scene.c").read_text().splitlines()[0]
    assert emission.hash in first_line


def test_deepest_stack_follows_the_calls() -> None:
    graph = (
        'node: { title: "a" label: "a\\nx.c:1:1\\n32 bytes (static)\\n0 dynamic objects" }\n'
        'node: { title: "b" label: "b\\nx.c:2:1\\n48 bytes (static)\\n0 dynamic objects" }\n'
        'node: { title: "memset" label: "__builtin_memset\\n<built-in>" shape : ellipse }\n'
        'edge: { sourcename: "a" targetname: "b" label: "x.c:1:2" }\n'
        'edge: { sourcename: "b" targetname: "memset" label: "x.c:2:2" }\n'
    )
    assert deepest_stack(graph) == 80
    assert deepest_stack(graph + 'edge: { sourcename: "b" targetname: "a" label: "" }\n') is None
