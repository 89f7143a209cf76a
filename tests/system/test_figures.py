"""README's figures are those that their command measures today."""

import re
import sys
from pathlib import Path

import boards
import judges
import pytest
import silences
from support.c.mcu import need
from support.pages.figures import AGAIN, COMMAND, PASSIVE, README, stored, written

from springpot import train


def test_readme_says_what_was_measured() -> None:
    page = README.read_text(encoding="utf-8")
    assert "<!-- figures: " in page and written(page, stored()) == page


def test_what_was_measured_is_what_is_measured_now() -> None:
    cells = {(cell["object"], cell["structure"]): cell for cell in stored()["cells"]}
    assert set(cells) == set(judges.all_cells())
    training, test, _ = judges.recordings(AGAIN, judges.SEED)
    measured = judges.measured(train(training, PASSIVE), training, test)
    known = cells[AGAIN]["models"][PASSIVE]
    assert measured["percent"] == pytest.approx(known["percent"], rel=1e-3), COMMAND
    assert measured["ram_bytes"] == known["ram_bytes"]


def test_a_model_that_fails_is_said_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ValueError("planted")

    monkeypatch.setattr(judges, "train", fail)
    cell = judges.judged(AGAIN, judges.SEED, "")
    assert all(model["failed"] == "ValueError: planted" for model in cell["models"].values())
    monkeypatch.setattr(judges, "judged", lambda *_: cell)
    monkeypatch.setattr(judges, "Memory", Unchanged)
    monkeypatch.setattr(judges, "Parallel", lambda **_: lambda jobs: [f(*a) for f, a, _ in jobs])
    monkeypatch.setattr(sys, "argv", ["judges.py", str(tmp_path), "--objects", AGAIN[0]])
    with pytest.raises(SystemExit, match="planted") as ended:
        judges.main()
    assert ended.value.code not in (0, None)


@pytest.mark.slow
def test_the_page_says_what_a_silence_does() -> None:
    """The greatest of its figures, measured again."""
    effects = list(silences.effects("ecoflex-00-30", "bare", 8.0, silences.SILENCES_S[-1]))
    given = f"{100 * max(effect.given for effect in effects):.0f} % (ecoflex-00-30, 8 Hz) |"
    row = r"^\| more energy given back, of a press, bare \|.*\| (.*)$"
    found = re.search(row, silences.PAGE.read_text(encoding="utf-8"), re.M)
    assert found and found[1] == given


@pytest.mark.slow
def test_the_page_says_what_a_tick_costs_on_a_board() -> None:
    """The first of its rows, measured again."""
    need("mps2-an386")
    assert boards.row("hammerstein", boards.presses()) in boards.PAGE.read_text(encoding="utf-8")


class Unchanged:
    """A cache that keeps nothing."""

    def __init__(self, *_: object, **__: object) -> None: ...

    def cache(self, function: object) -> object:
        return function
