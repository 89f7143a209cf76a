"""Calls of `import springpot`: the same results as the rooms below, and refusals of one line."""

import json
import logging
import subprocess
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from support import small
from support.in_process import spring

import springpot
from springpot.codegen.errors import DataError, UsageError
from springpot.host.files import write_scene
from springpot.trainer.models.predict import predict_n


@pytest.mark.slow
def test_emit_writes_what_the_command_writes(tmp_path, folder):
    small.model_file(tmp_path)
    file = tmp_path / "scene.toml"
    write_scene(file, small.scene())
    assert spring("emit", "--scene", file, "--out", tmp_path / "c").returncode == 0
    springpot.emit(tmp_path / "again", scene=str(file))
    for other in (tmp_path / "c", tmp_path / "again"):
        for name in ("sp.c", "manifest.json", "from/model.spm"):
            assert (other / name).read_bytes() == (folder / name).read_bytes()


def test_a_model_alone_is_a_scene_of_defaults(tmp_path):
    emission = springpot.emit(tmp_path / "c", model=small.passive_model())
    assert emission.plan.scene == springpot.Scene(1, "small", "model.spm")
    assert emission.as_dict()["hash"] == emission.manifest["hash"]
    told = spring("emit", "--model", small.model_file(tmp_path), "--out", tmp_path / "b", "--json")
    assert json.loads(told.stdout)["hash"] == emission.hash
    for command in (("emit", "--out", tmp_path / "no"), ("stability",)):
        refused = spring(*command)
        assert refused.returncode == 2 and "give --model" in refused.stderr


def test_run_takes_lists_and_velocities(folder):
    loaded, position_m = springpot.load(folder), [0.0, 1e-4, 3e-4]
    by_default, _ = loaded.run(position_m)
    given, _ = loaded.run(position_m, np.diff(position_m, prepend=0.0) / loaded.dt_s)
    np.testing.assert_allclose(by_default, given, rtol=1e-6)
    force_n, notes = loaded.new_state().step(position_m[0])
    assert (force_n, notes) == (by_default[0], loaded.run(position_m)[1][0])


def test_run_says_that_positions_are_millimetres(folder):
    loaded = springpot.load(folder)
    deepest_m = loaded.manifest["trained"]["depth_m"][1]
    loaded.run(np.linspace(-50.0 * deepest_m, 9.0 * deepest_m, 50))  # air, and deep
    with pytest.warns(UserWarning, match="give positions in metres"):
        force_n, _ = loaded.run(np.linspace(0.0, 1e3 * deepest_m, 50))
    assert force_n.shape == (50,)


def test_predict_is_the_model_above_zero():
    rec = small.training()[-1]
    force_n = springpot.predict(small.passive_model(), list(rec.position_m), dt_s=small.DT_S)
    assert force_n.shape == rec.force_n.shape and np.max(np.abs(force_n - rec.force_n)) < 1.0
    moved = replace(small.passive_model(), contact="always")
    assert springpot.predict(moved, rec.position_m).shape == rec.force_n.shape
    memory = springpot.train(small.training(), "springpot").model
    assert predict_n(replace(memory, contact="always"), rec).min() < 0.0
    assert springpot.predict(memory, rec.position_m).min() == 0.0


def test_predict_says_what_is_extrapolated_and_refuses_millimetres():
    model, deepest_m = small.passive_model(), small.passive_model().trained.max_m
    top_m = np.arange(0.0, deepest_m, model.trained.max_mps * small.DT_S)  # at the trained speed
    springpot.predict(model, top_m[::3])
    for times, of, position_m in ((1.9, "depth", 1.92 * top_m), (6, "speed", top_m[::6])):
        with pytest.warns(UserWarning, match=f"{times} times the trained {of}"):
            springpot.predict(model, position_m)
    away_m = np.linspace(-30.0 * deepest_m, 0.0, 50)  # air: no way into the object
    assert np.all(springpot.predict(model, away_m) == springpot.predict(model, [0.0, 0.0])[0])
    for position_m in (np.linspace(0, 12 * deepest_m, 50), 1e3 * small.training()[0].position_m):
        with pytest.raises(DataError, match="give positions in metres"):
            springpot.predict(model, position_m)


@pytest.mark.parametrize(
    ("held_s", "share", "told"), [(5, 0.6, True), (3, 0.6, False), (9, 0, False)]
)
def test_a_hold_longer_than_training_is_an_extrapolation(held_s, share, told):
    """Training recordings last 2 s at most; above the object no hold is told."""
    model = small.passive_model()
    deep_m = share * model.trained.max_m
    noise_m = np.random.default_rng(0).uniform(-2e-3, 2e-3, 1000 * held_s) * model.trained.max_m
    position_m = np.concatenate([small.press(0.5, deep_m)[:1000], deep_m + noise_m])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        springpot.predict(model, position_m)
    assert [f"holds still for {held_s}" in str(one.message) for one in caught] == [True] * told


def test_good_news_is_logged_and_doubts_are_warnings(tmp_path, caplog, capsys):
    caplog.set_level(logging.INFO, "springpot")
    rec = small.recording("press", np.concatenate([small.press(hz) for hz in (0.5, 1.6, 5.0)]))
    rows = np.c_[np.arange(len(rec.force_n)) * small.DT_S, 1e3 * rec.position_m, rec.force_n]
    file = tmp_path / "press.csv"
    np.savetxt(file, rows, "%.9g", ",", header="t,x,f", comments="")
    with pytest.raises(UsageError, match="no files: give at least one"):
        springpot.import_recordings([])
    (found,) = springpot.import_recordings(file, "time=t:s,position=x:mm,force=f:N")
    np.testing.assert_allclose(found.position_m, rec.position_m, atol=1e-9)
    assert str(file) in caplog.text and springpot.check_recordings(found).sign_words in caplog.text
    rows[:, 2] = np.round(rows[:, 2])
    np.savetxt(file, rows, "%.9g", ",", header="t,x,f", comments="")
    with pytest.warns(UserWarning, match="force has steps of 1 N") as warned:
        springpot.import_recordings(file, "time=t:s,position=x:mm,force=f:N")
    assert {each.filename for each in warned} == {__file__} and capsys.readouterr().err == ""
    done = spring("import", file, "--map", "time=t:s,position=x:mm,force=f:N", "--out", tmp_path)
    assert "clockwise" in done.stderr


def test_lists_and_single_ones_are_taken(tmp_path, folder):
    one = small.training()[-1]
    lists = springpot.Recording("a", list(one.position_m), one.force_n.tolist(), small.DT_S)
    assert lists.content_hash == one.content_hash
    springpot.write_recordings(tmp_path / "a.h5", one)
    for given in (one, str(tmp_path), [tmp_path], [one]):
        (checked,) = springpot.check_recordings(given).checked
        assert checked.content_hash == one.content_hash
    fit = small.small_fit()
    springpot.write_model(tmp_path / "a.spm", fit)
    for given in (fit, tmp_path / "a.spm"):
        force_n = springpot.predict(given, one.position_m)
        np.testing.assert_array_equal(force_n, springpot.predict(fit.model, one.position_m))
    assert springpot.validate(folder, one, paced_s=0.01).mismatches == 0


@pytest.fixture(autouse=True)
def no_figure_stays() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_a_recording_is_force_against_position(monkeypatch: pytest.MonkeyPatch) -> None:
    one, axes = small.training()[0], pyplot.figure().subplots()
    assert one.plot(axes) is axes
    np.testing.assert_array_equal(axes.lines[0].get_xydata().T, [1e3 * one.position_m, one.force_n])
    assert isinstance(one.plot(), Axes)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(UsageError, match=r"pip install 'springpot\[report\]'"):
        one.plot()


@pytest.mark.parametrize("call", ["train(one, 'rf-fd')", "bench(one)", "from_ensemble"])
def test_without_the_extra_one_line_says_what_to_install(call: str) -> None:
    x_m = "1e-3 - 1e-3 * np.cos(np.arange(4000) / 100)"
    one = f"x_m = {x_m}; one = springpot.Recording('a', x_m, 1e3 * x_m, 1e-3)"
    script = f"import numpy as np, springpot, sys; {one}; sys.modules['sklearn'] = None; springpot."
    ran = [sys.executable, "-c", script + call]
    done = subprocess.run(ran, check=False, capture_output=True, text=True)
    assert done.stderr.endswith(
        "UsageError: sklearn is not installed: pip install 'springpot[train]'\n"
    )


def modules_after(statement: str) -> set[str]:
    """Top-level modules of a fresh interpreter, and springpot's own."""
    script = (
        f"import sys\nbefore = set(sys.modules)\n{statement}\nprint(*set(sys.modules) - before)"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True)  # fmt: skip
    return set(result.stdout.split())


def test_import_alone_loads_nothing() -> None:
    loaded = modules_after("import springpot; dir(springpot)")
    assert {name for name in loaded if name.startswith("springpot")} == {"springpot"}
    assert not loaded & {"numpy", "click", "rich", "h5py", "pydantic", "cffi", "importlib.metadata"}
