"""What results show of themselves: a short line, a table, a picture."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from support.small import passive_model, training

import springpot
from springpot.host.session.outcome import NOTE_WORDS
from springpot.host.wings.report import faces

# What the command line prints of each.
ROWS = {
    "Recording": "cycles Hz", "QualityReport": "your recordings cover", "Fit": "memory",
    "Emission": "stiffness felt", "Validation": "error / JND", "Stability": "spectral radius",
}  # fmt: skip
MOST_HTML = 200_000  # characters
BIT, WORDS = next(iter(NOTE_WORDS.items()))


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("emitted") / "c"
    recordings = list(training()[:3])
    emission = springpot.emit(folder, model=passive_model())
    results = [
        recordings[0],
        springpot.check_recordings(recordings),
        springpot.train(recordings, "springpot"),
        emission,
        springpot.validate(folder, recordings, paced_s=0.01),
        springpot.stability(model=passive_model()),
    ]
    return {type(each).__name__: each for each in results}


@pytest.fixture(autouse=True)
def no_figure_stays():
    yield
    pyplot.close("all")


@pytest.mark.slow
@pytest.mark.parametrize("name", ROWS)
def test_a_result_is_a_line_a_table_and_a_picture(shown, name, monkeypatch):
    result = shown[name]
    assert repr(result).startswith(name)
    assert len(repr(result)) <= 200
    assert "\n" not in repr(result)
    html = result._repr_html_()
    assert ROWS[name] in html
    assert "<svg" in html
    assert len(html) < MOST_HTML
    axes = pyplot.figure().subplots()
    assert result.plot(ax=axes) is axes
    assert axes.lines or axes.images
    assert isinstance(result.plot(), Axes)
    monkeypatch.setattr(faces, "find_spec", lambda _: None)
    assert "<svg" not in result._repr_html_()
    with pytest.raises(springpot.UsageError, match=r"pip install 'springpot\[report\]'"):
        result.plot()


@pytest.mark.slow
def test_names_are_no_markup(shown):
    assert "<b>" not in replace(shown["Fit"], warnings=("<b>",))._repr_html_()


@pytest.mark.slow
def test_a_validation_draws_what_was_measured(shown):
    found = shown["Validation"]
    measured, of_c = (line.get_ydata() for line in found.plot().lines)
    k = [len(each.force_n) for each in found.recordings].index(len(measured))
    np.testing.assert_array_equal(measured, found.recordings[k].force_n)
    np.testing.assert_array_equal(of_c, found.predicted_n[k])


def test_a_log_marks_the_ticks_that_the_c_noted():
    one = training()[0]
    notes = np.where(np.arange(len(one.force_n)) < 7, BIT, 0).astype(float)
    axes = replace(one, channels={"notes": notes}).plot()
    (dots,) = [line for line in axes.lines if line.get_label() == WORDS]
    assert len(dots.get_xdata()) == 7
