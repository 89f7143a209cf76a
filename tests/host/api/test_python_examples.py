"""The code of README.md, docs/reference/python.md and every docstring, run as it stands there."""

import doctest
import re

import numpy as np
import pytest
from sklearn.ensemble import RandomForestRegressor
from sklearn.model_selection import cross_val_score
from support.paths import ROOT
from support.small import passive_model, training

import springpot
from springpot.codegen.errors import DataError
from springpot.codegen.scene import Guard
from springpot.host.ensemble import ensemble_data
from springpot.host.files import write_scene


def example(file: str) -> str:
    """Its blocks of Python, in the order of the page."""
    found = re.findall(r"^```python\n(.*?)^```", (ROOT / file).read_text(), re.M | re.S)
    assert found, file
    return "\n".join(found)


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.slow
def test_six_lines_of_the_readme():
    code = example("README.md")
    assert len([line for line in code.splitlines() if line.strip()]) <= 6
    names: dict = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["force_n"].shape == names["training"][0].position_m.shape
    assert np.max(np.abs(names["force_n"] - names["training"][0].force_n)) < 0.2


@pytest.mark.slow
def test_from_a_recording_to_a_felt_session(capsys, tmp_path):
    (tmp_path / "felt.h5").touch()  # of a run before
    names: dict = {}
    exec(compile(example("docs/reference/python.md"), "docs/reference/python.md", "exec"), names)
    assert "mN" in capsys.readouterr().out and names["session"].error is None
    assert names["session"].result()["ticks"] == len(names["felt"][0].force_n)
    assert names["felt"][0].force_n.max() > 0.5


@pytest.fixture(scope="module")
def around(tmp_path_factory):
    """What the examples of docstrings find: a folder with files, and names."""
    folder = tmp_path_factory.mktemp("around")
    recordings, model = list(training()[:3]), passive_model()
    (folder / "training").mkdir()
    for number, each in enumerate(recordings):
        springpot.write_recordings(folder / "training" / f"{number}.h5", each)
    press = recordings[0]
    time_s = np.arange(len(press.force_n)) * press.dt_s
    rows = np.column_stack([time_s, 1e3 * press.position_m, press.force_n])
    np.savetxt(folder / "press.csv", rows, delimiter=",", header="t,x,f", comments="")
    springpot.write_model(folder / "model.spm", model)
    write_scene(folder / "scene.toml", springpot.Scene(1, "pad", "model.spm"))
    springpot.emit(folder / "c", model=model)
    names = {name: getattr(springpot, name) for name in dir(springpot)}
    names |= {"recordings": recordings, "press": press, "model": model}
    return folder, names | {
        "Guard": Guard,
        "DataError": DataError,
        "ensemble_data": ensemble_data,
        "RandomForestRegressor": RandomForestRegressor,
        "cross_val_score": cross_val_score,
    }


def examples(name, names):
    docstring = getattr(springpot, name).__doc__
    return doctest.DocTestParser().get_doctest(docstring, names, name, None, 0)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # three recordings: few speeds, few holds
@pytest.mark.parametrize("name", dir(springpot))
def test_the_example_of_a_docstring_runs(name, around, monkeypatch):
    folder, names = around
    monkeypatch.chdir(folder)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    assert runner.run(examples(name, names)).failed == 0
