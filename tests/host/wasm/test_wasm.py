"""Every stored model as WebAssembly: its self-test in node, and the forces of this machine."""

import hashlib
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.bench_folder import asked, small
from support.c import golden_forces
from support.c.cross_tools import path_without

from springpot.codegen.emit.files import emit_files
from springpot.codegen.emit.golden import backward_velocity, golden_positions
from springpot.codegen.errors import BudgetError, MismatchError
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.reference.run import run_reference
from springpot.codegen.scene import Budget, Scene, Target
from springpot.host.emission.emission import emit, read_emission
from springpot.host.evidence.benchmark.choice import choose_pick, scene_of
from springpot.host.evidence.benchmark.report import bench_page
from springpot.host.evidence.benchmark.run import run_bench
from springpot.host.native.compiler import CompilerError
from springpot.host.native.toolchain import missing_tools
from springpot.host.page.press_page import check_module, write_press_page
from springpot.host.wasm import wasm_node
from springpot.host.wasm.wasm_module import scene_module
from springpot.host.wasm.wasm_node import WasmTicks, missing_node, run_in_node
from springpot.runtime_c.paths import SIM

WASM_LD = shutil.which("wasm-ld")
pytestmark = [pytest.mark.board, pytest.mark.slow]


def need(node: bool = True) -> None:
    if lacking := missing_tools("wasm32") or (node and missing_node()):
        pytest.skip(lacking)


def emitted(folder: Path, name: str, number: str, mode: str, target: Target) -> Path:
    scene = golden_forces.scene(name, number, mode)
    scene = replace(scene, runtime=replace(scene.runtime, target=target))
    folder.mkdir()
    plan = make_plan(golden_forces.model(name), scene, accept_unsafe=True)
    for file, text in emit_files(plan).items():
        (folder / file).write_text(text)
    return folder


@pytest.mark.parametrize(("number", "mode"), golden_forces.EACH_MODE)
@pytest.mark.parametrize("name", golden_forces.models())
def test_the_same_forces_in_node(tmp_path: Path, name: str, number: str, mode: str) -> None:
    need()
    position = golden_forces.motion_m().astype(number)
    velocity = backward_velocity(position, 1e-3)
    wanted = golden_forces.force_hash(*golden_forces.replayed(name, number, mode))
    for target in ("wasm32", "host") if mode == "proxy" else ("wasm32",):
        folder = emitted(tmp_path / target, name, number, mode, target)
        ticks = run_in_node(scene_module(folder), "sp", position, velocity)
        assert ticks.selftest == 0
        assert golden_forces.force_hash(ticks.force_n, ticks.notes) == wanted, target


def test_what_nobody_defines_is_named(tmp_path: Path) -> None:
    need(node=False)
    folder = emitted(tmp_path / "c", "hammerstein", "float32", "off", "wasm32")
    noisy, exports = [SIM / "sim_noise.c"], ["sim_noise_normal"]
    with pytest.raises(CompilerError, match=r"undefined symbol: (log|cos)"):
        scene_module(folder, noisy, include=[SIM], exports=exports)
    with pytest.raises(CompilerError, match="nowhere"):
        scene_module(folder, exports=["nowhere"])


def stored_scene(**budget: int) -> tuple[Scene, Path]:
    scene = golden_forces.scene("hammerstein", "float64", "off")
    runtime = replace(scene.runtime, target="wasm32")
    model_file = golden_forces.FOLDER / "hammerstein.spm"
    return replace(scene, runtime=runtime, budget=Budget(**budget)), model_file


def test_emission_states_the_module_and_runs_its_selftest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need()
    scene, model_file = stored_scene()
    emission = emit(scene, model_file, tmp_path / "c")
    assert 2000 < emission.footprint.flash_bytes < len(scene_module(tmp_path / "c"))
    assert emission.footprint.stack_bytes is None
    assert not emission.notices
    with pytest.raises(BudgetError, match=r"stack: .* is set where it is linked"):
        emit(*stored_scene(stack_bytes=1000), tmp_path / "c")
    with pytest.raises(BudgetError, match=r"flash: .* the scene's budget is 1000"):
        emit(*stored_scene(flash_bytes=1000), tmp_path / "c")

    def differs(*given: Any) -> WasmTicks:
        return replace(run_in_node(*given), selftest=8)

    monkeypatch.setattr(wasm_node, "run_in_node", differs)
    with pytest.raises(MismatchError, match="golden tick 7: nothing was emitted"):
        emit(scene, model_file, tmp_path / "c")
    monkeypatch.setenv("PATH", path_without(tmp_path / "bin"))
    (tmp_path / "bin" / "wasm-ld").symlink_to(WASM_LD)
    (told,) = emit(scene, model_file, tmp_path / "c").notices
    assert told == "the self-test has not run as wasm32: no node on PATH: `apt-get install nodejs`"


def test_a_benchmark_picks_for_a_page_and_times_it(tmp_path: Path) -> None:
    need()
    bench = replace(asked(kinds=("hammerstein",)), target="wasm32")
    with small():
        result = run_bench(bench, tmp_path / "bench", "springpot bench")
        again = run_bench(bench, tmp_path / "bench", "springpot bench")
    assert again["computed_isolated"] == 0
    picked = result["picks"]["wasm32"]["point"]
    (point,) = (point for point in result["points"] if point["key"] == picked)
    assert 2000 < point["flash_bytes"] < 120 * 1024
    assert point["node_tick_ns"] > 0.0 < point["portable_tick_ns"]
    assert point["node_why"] is None
    text = bench_page(result, "bench")
    assert "a tick in node, where the same C takes" in text
    assert "120 kB of flash.\n" in text
    chosen = choose_pick(tmp_path / "bench", "wasm32")
    scene, _ = scene_of(tmp_path / "bench", *chosen, None)
    assert scene.runtime.target == "wasm32"
    assert scene.budget == Budget(flash_bytes=120 * 1024)


def test_a_page_has_the_forces_of_this_machine(tmp_path: Path) -> None:
    need()
    folder = tmp_path / "c"
    emit(*stored_scene(), folder)
    (entry,) = write_press_page([folder], tmp_path / "press.html")
    found = check_module(folder, entry, accept_edited=False)
    plan = read_emission(folder).plan
    force_n = run_reference(plan, golden_positions(plan)).force_n
    assert found == {"selftest": 0, "force_hash": hashlib.sha256(force_n.tobytes()).hexdigest()}
    other = replace(golden_forces.scene("rf-fd", "float32", "off"), name="other")
    emit(other, golden_forces.FOLDER / "rf-fd.spm", tmp_path / "other", accept_unsafe=True)
    (wrong,) = write_press_page([tmp_path / "other"], tmp_path / "other.html")
    with pytest.raises(MismatchError, match="gives other forces in node"):
        check_module(folder, wrong, accept_edited=False)
