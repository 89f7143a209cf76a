"""Emitted folders: the same bytes again, warning-clean, nothing unreachable, by hand.

`emit --fit`: what does not fit a budget is made smaller, measured on recordings.
"""

import dataclasses
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest
from support.messages import refusing
from support.small import (
    model_file,
    passive_model,
    press,
    recording,
    scene,
    small_fit,
    small_model,
    written_model,
)

from springpot.codegen.errors import BudgetError, DataError, MismatchError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Budget, Scene
from springpot.host.emission.boards import BOARDS, build_firmware
from springpot.host.emission.budget_fit import emit_fitting
from springpot.host.emission.emission import emit, read_emission
from springpot.host.emission.result import Emission, over_budget
from springpot.host.native.scene_library import SceneLibrary
from springpot.host.pages.wasm_module import page_module
from springpot.host.validation.validation import validate
from springpot.runtime_c.paths import flags

SHAPES = {
    "plain": scene(),
    "paper": scene(mode="tool", smoothing_s=8.3e-4, number="float64"),
    "prefixed": scene(prefix="eco", mode="tool"),
    "m2cgen": scene(),
}
CPU_FLAGS = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]


Emitted = Callable[[str], Emission]


def model(shape: str) -> Model:
    return written_model() if shape == "m2cgen" else passive_model()


@pytest.fixture(scope="module")
def emission_of(tmp_path_factory: pytest.TempPathFactory) -> Emitted:
    """Each shape emitted once, to be read."""

    @cache
    def emission(shape: str) -> Emission:
        above = tmp_path_factory.mktemp(shape)
        return emit(SHAPES[shape], model_file(above, model(shape)), above / "c")

    return emission


@pytest.mark.few(1)
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("shape", list(SHAPES))
def test_generated_c_is_warning_clean(
    tmp_path: Path, emission_of: Emitted, shape: str, compiler: str
) -> None:
    sources = sorted(emission_of(shape).folder.glob("*.c"))
    assert len(sources) == 2
    for source in sources:
        command = [compiler, *flags("SP_CFLAGS"), *flags("SP_STRICT"), "-c", str(source), "-o",
                   str(tmp_path / "object.o")]  # fmt: skip
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
        assert result.stderr == ""


@pytest.mark.parametrize("shape", ["plain", "m2cgen"])
def test_builds_by_hand_without_python(tmp_path: Path, emission_of: Emitted, shape: str) -> None:
    emission = emission_of(shape)
    shutil.copytree(emission.folder, tmp_path / "c")
    clean = {"PATH": "/usr/bin:/bin", "LC_ALL": "C"}
    subprocess.run(["make", "-C", tmp_path / "c", "test"], env=clean, check=True,
                   capture_output=True)  # fmt: skip
    result = subprocess.run([tmp_path / "c" / "example"], input="0\n0.001\r\n\n0.002\n\n",
                            text=True, capture_output=True, check=True)  # fmt: skip
    assert f'"hash": "{emission.hash}"' in result.stderr
    forces = [float(line.split()[0]) for line in result.stdout.splitlines()]
    state = SceneLibrary(tmp_path / "c").new_state()
    ways = ((0.0, 0.0), (0.001, 1.0), (0.002, 1.0))  # a millimetre a tick: 1 m/s
    assert forces == pytest.approx([state.step(*way)[0] for way in ways])
    assert forces[0] == 0.0 < forces[2]
    for line in ("x", "1 2", f"0.{'1' * 90}"):
        wrong = subprocess.run([tmp_path / "c" / "example"], input=f"0\n{line}\n", text=True,
                               capture_output=True, check=False)  # fmt: skip
        assert (wrong.returncode, len(wrong.stdout.splitlines())) == (1, 1)
        assert "line 2 is not a number" in wrong.stderr


@pytest.mark.parametrize("make", ["firmware", "page"])
def test_what_needs_libm_is_for_no_board_and_no_page(
    tmp_path: Path, emission_of: Emitted, make: str
) -> None:
    emission = emission_of("m2cgen")
    folder, plan = emission.folder, emission.plan
    with refusing(UsageError, "libm", "fit trees"):
        if make == "page":
            page_module(folder, plan)
        else:
            build_firmware(folder, plan, BOARDS["mps2-an386"], tmp_path / "firmware")


CONTRACTED = ("-mfma", "-ffp-contract=fast")  # the file keeps the two operations apart
HIDDEN = ("-ffinite-math-only", "-U__FINITE_MATH_ONLY__")  # a compiler that does not say so


@pytest.mark.parametrize(
    ("shape", "options", "safe"),
    [("plain", CONTRACTED, True), ("prefixed", CONTRACTED, True), ("plain", HIDDEN, False)],
)
def test_the_selftest_sees_other_floating_point_and_nan_assumed_away(
    tmp_path: Path, emission_of: Emitted, shape: str, options: tuple[str, ...], safe: bool
) -> None:
    if "-mfma" in options and "fma" not in CPU_FLAGS:
        pytest.skip("this processor has no fused multiply-add")
    sources = sorted(emission_of(shape).folder.glob("*.c"))
    for more, passes in (((), True), (options, safe)):
        program = tmp_path / "program"
        command = ["gcc", *flags("SP_CFLAGS"), *more, *sources, "-o", program, "-lm"]
        subprocess.run(command, check=True)
        result = subprocess.run([program], input="", capture_output=True, text=True, check=False)
        assert (result.returncode == 0) is passes
        assert ("self-test passed" if passes else "-ffp-contract=off") in result.stderr


def test_a_library_that_differs_is_not_emitted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SceneLibrary, "selftest", lambda _: 3)
    with pytest.raises(MismatchError, match="golden tick 2"):
        emit(SHAPES["plain"], model_file(tmp_path), tmp_path / "c")
    assert [path.name for path in tmp_path.iterdir()] == ["model.spm"]


@pytest.mark.slow
def test_emission_replaces_its_own_folder_and_no_other(tmp_path: Path) -> None:
    model, mine = model_file(tmp_path), tmp_path / "mine"
    for shape in ("paper", "plain"):
        emit(SHAPES[shape], model, tmp_path / "c")
    assert not (tmp_path / "c" / "sp_couple.h").exists()
    mine.mkdir()
    (mine / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="did not emit"):
        emit(SHAPES["plain"], model, mine)
    assert (mine / "thesis.txt").read_text() == "mine"


def test_emission_never_overwrites_what_a_user_changed(tmp_path: Path) -> None:
    model = model_file(tmp_path)
    emit(SHAPES["plain"], model, tmp_path / "c")
    (tmp_path / "c.old").mkdir()
    for name in ("mine.c", "from/note.txt", "main.c"):
        file = tmp_path / "c" / name
        file.write_text("mine")
        with pytest.raises(UsageError, match=name):
            emit(SHAPES["plain"], model, tmp_path / "c")
        assert file.read_text() == "mine" and (tmp_path / "c.old").exists()
        file.unlink()


def test_budget_is_kept(tmp_path: Path) -> None:
    tight = replace(SHAPES["plain"], budget=Budget(flash_bytes=1000))
    with pytest.raises(BudgetError, match="the scene's budget is 1000"):
        emit(tight, model_file(tmp_path), tmp_path / "c")
    assert not (tmp_path / "c").exists()


EVALUATION = recording("judge", press(1.5, 0.011))


@pytest.fixture(scope="module")
def tight(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, Model, int]:
    """A scene whose budget is two thirds of what the model takes."""
    folder, model = tmp_path_factory.mktemp("tight"), small_fit(trees=10).model
    whole = emit(scene(), model, folder / "whole").footprint
    budget = Budget(flash_bytes=2 * whole.flash_bytes // 3)
    return dataclasses.replace(scene(), budget=budget), model, 2 * whole.flash_bytes // 3


@pytest.mark.slow
def test_the_best_forest_that_fits_is_emitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], tight: tuple[Scene, Model, int]
) -> None:
    chosen, model, flash_bytes = tight
    with pytest.raises(BudgetError, match="--fit --recording REC makes a forest smaller"):
        emit_fitting(chosen, model, tmp_path / "c", False, [EVALUATION], fit=False)
    assert not (tmp_path / "c").exists()
    fitted = emit_fitting(chosen, model, tmp_path / "c", False, [EVALUATION], fit=True)
    assert fitted.footprint.flash_bytes <= flash_bytes
    (line,) = [one for one in capsys.readouterr().err.splitlines() if one.startswith("fitted: ")]
    said_n = float(line.split("RMSE ")[1].split()[0])
    measured = validate(tmp_path / "c", [EVALUATION], paced_s=0.01)
    assert said_n == pytest.approx(measured.accuracy.rmse_n, rel=1e-3)


@pytest.mark.parametrize(
    ("recordings", "fit", "budget", "error", "told"),
    [
        ([dataclasses.replace(EVALUATION, dt_s=2e-3)], True, None, DataError, "500 Hz, the scene"),
        ([], True, None, UsageError, "give --recording REC"),
        ([], False, None, BudgetError, "--fit --recording REC"),
        ([EVALUATION], True, Budget(flash_bytes=100), BudgetError, "no smaller version of this"),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    tmp_path, tight, recordings, fit, budget, error, told
) -> None:
    chosen, model, _ = tight
    if budget:
        chosen, model = dataclasses.replace(chosen, budget=budget), small_model()
    with pytest.raises(error, match=told):
        emit_fitting(chosen, model, tmp_path / "c", False, recordings, fit=fit)


@pytest.mark.parametrize("beside", ["validation/rows.csv", "example/main.c", "report.html"])
def test_what_springpot_put_beside_an_emission_goes_with_it(tmp_path: Path, beside: str) -> None:
    emit(scene(), passive_model(), tmp_path / "c")
    (tmp_path / "c" / beside).parent.mkdir(exist_ok=True)
    (tmp_path / "c" / beside).write_text("later")
    emit(scene(), passive_model(), tmp_path / "c")
    assert not (tmp_path / "c" / beside).exists()


@pytest.mark.parametrize("size", ["flash", "ram", "stack"])
def test_a_budget_of_what_it_takes_is_kept_and_a_byte_less_is_not(size: str) -> None:
    emission = SimpleNamespace(flash_bytes=900, ram_bytes=80, stack_bytes=70, unmeasured="")
    has = getattr(emission, f"{size}_bytes")
    assert over_budget(emission, Budget(**{f"{size}_bytes": has})) == ""
    over = over_budget(emission, Budget(**{f"{size}_bytes": has - 1}))
    assert over.lower() == f"{size}: {has} bytes, the scene's budget is {has - 1}"


def test_the_limits_that_are_stated_are_those_that_act(tmp_path: Path) -> None:
    emission = emit(scene(), passive_model(), tmp_path / "c")
    plan = read_emission(tmp_path / "c").plan
    limits = emission.manifest["limits"]
    assert limits["slew_nps"] * plan.dt_s == pytest.approx(float(plan.output.slew_n))
    header = (tmp_path / "c/sp.h").read_text()
    (stated,) = re.findall(r"WATCHDOG_S .*?([0-9.]+)f?\b", header)
    assert float(stated) == pytest.approx(plan.watchdog_s) == pytest.approx(0.02)
