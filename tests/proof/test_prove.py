"""The analysis itself: it passes what is right, and the planted defects are still defects."""

from pathlib import Path

import pytest
from proof.eva.analysis import Precision, alarms_in, frama_c, unbounded_in
from proof.eva.defects import DEFECTS, Defect, analyse_defect, plant_defect
from proof.eva.ports import PORT_DRIVERS, PORTS, Port, analyse_port
from proof.eva.scene_analysis import analyse_scene
from proof.eva.scenes import ProvedScene, emit_scene, proved_scenes

from springpot.runtime_c.paths import SOURCE
from springpot.trainer.kinds import KINDS

needs_frama_c = pytest.mark.skipif(frama_c() is None, reason="no frama-c (frama-c-base)")
SAID = """\
[eva:alarm] sp_curve.h:38: Warning:
  out of bounds read. assert \\valid_read(term + i);
[eva] done for function prove
[eva:final-states] Values at end of function prove:
  state.silence.silent_s ∈ [0. .. 0.0205]
       .output{.model_n; .aim_n} ∈
       [-inf .. inf] ∪ {NaN}
       .output.ramp ∈ [0. .. 1.2]
[eva:summary] ====== ANALYSIS SUMMARY ======
"""


def test_alarms_and_states_without_bounds_are_found() -> None:
    (alarm,), (state,) = alarms_in(SAID), unbounded_in(SAID)
    assert "sp_curve.h:38" in alarm and ".output{.model_n; .aim_n} in [-inf .. inf]" in state


def test_a_loop_that_never_ends_proves_nothing() -> None:
    assert "does not end" in unbounded_in("[eva] done for function prove\n")[0]


def test_functions_that_are_not_there_are_not_named_to_the_analyser() -> None:
    precision = Precision({"there": 3, "gone": 4}, (), {"gone": 5})
    assert precision.options("int there(void);") == ["-eva-slevel-function", "there:3"]


def test_every_kind_coupling_and_number_is_analysed() -> None:
    scenes = {(one.kind, one.coupling, one.number) for one in proved_scenes()}
    for kind in KINDS:
        for coupling in ("off", "tool", "proxy"):
            assert (kind, coupling, "float32") in scenes and (kind, coupling, "float64") in scenes
    assert {one.name for one in PORT_DRIVERS} == {path.stem for path in PORTS.glob("*.c")}


@pytest.mark.parametrize("defect", DEFECTS, ids=lambda defect: defect.what)
def test_the_code_has_what_a_defect_changes(defect: Defect) -> None:
    assert defect.right in (SOURCE / defect.file).read_text()


@pytest.mark.slow
@pytest.mark.parametrize("defect", DEFECTS, ids=lambda defect: defect.what)
def test_the_emitted_code_has_what_a_defect_changes(defect: Defect, tmp_path: Path) -> None:
    assert (plant_defect(defect, tmp_path) / "sp.c").exists()


@pytest.mark.parametrize("port", PORT_DRIVERS, ids=lambda port: port.name)
def test_a_port_has_the_functions_that_its_analysis_names(port: Port) -> None:
    files = [PORTS / f"{port.name}.c", *(SOURCE.parent / "port").rglob("*.c")]
    text = "".join(path.read_text() for path in files)
    for name in (*port.precision.apart, *port.precision.by_result):
        assert f"{name}(" in text


@pytest.mark.slow
@needs_frama_c
def test_a_scene_has_no_alarm(tmp_path: Path) -> None:
    folder = emit_scene(ProvedScene("hammerstein", "off", "float32"), tmp_path)
    assert analyse_scene(folder).alarms == ()


@pytest.mark.slow
@needs_frama_c
def test_a_planted_defect_is_seen(tmp_path: Path) -> None:
    clamp = next(one for one in DEFECTS if one.what == "the force's clamp removed")
    assert any("limit" in alarm for alarm in analyse_defect(clamp, tmp_path).alarms)


@needs_frama_c
def test_a_link_has_no_alarm(tmp_path: Path) -> None:
    link = next(one for one in PORT_DRIVERS if one.name == "dhd")
    assert analyse_port(link, tmp_path).alarms == ()
