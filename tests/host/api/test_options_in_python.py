"""What Python says names arguments, and no options of the command line."""

import inspect
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import springpot
from springpot import Recording
from springpot.host.console.in_python import in_python
from springpot.host.console.quality import warn_of_quality
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.importing import ImportOptions

OWNERS = {"ImportOptions": ImportOptions, "Conditioning": Conditioning}
TIME_S = np.arange(1000) * 1e-2
DEPTH_M = 2e-3 - 3e-3 * np.cos(TIME_S)


def refused_or_warned(recording: Recording) -> list[str]:
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            warn_of_quality([recording])  # as train and import_recordings do
        except springpot.SpringpotError as error:
            return [str(error)]
    return [str(each.message) for each in said]


@pytest.mark.parametrize(
    ("position_m", "force_n", "argument"),
    [
        (DEPTH_M, 3.0 - 500.0 * DEPTH_M, "columns="),
        (DEPTH_M, 1.0 + 500.0 * np.maximum(DEPTH_M, 0.0), "tare='auto'"),
        (DEPTH_M + 9e-3, 500.0 * np.maximum(DEPTH_M, 0.0), "contact_force='auto'"),
    ],
    ids=["sign", "tare", "surface"],
)
def test_a_remedy_is_an_argument(
    position_m: np.ndarray, force_n: np.ndarray, argument: str
) -> None:
    said = refused_or_warned(Recording("a", position_m, force_n, 1e-2))
    assert any(argument in line for line in said)
    assert not any(re.search(r"--[a-z]", line) for line in said)


@pytest.mark.parametrize(
    ("shell", "python"),
    [
        ("--map 'force=Load (N):-1N'.", "columns='force=Load (N):-1N'."),
        (
            "take a column (--map), or --resample-hz 100",
            "take a column (columns), or resample_hz=100",
        ),
        ("--zero first or min", "zero='first' or min"),
        (
            "pass --place X,Y and --align",
            "pass ImportOptions(place_m=(X, Y)) and Conditioning(align=True)",
        ),
        ("--resample-hz 1e+06, --mass-kg 5e4", "resample_hz=1e+06, Conditioning(mass_kg=5e4)"),
        (
            "--decimal comma, or --decimal point",
            "ImportOptions(decimal='comma'), or ImportOptions(decimal='point')",
        ),
        ("--smooth-s 0.025: lasts", "smooth_s=0.025: lasts"),
    ],
)
def test_words(shell: str, python: str) -> None:
    assert in_python(shell) == python


def test_every_option_in_a_message_on_recordings_is_an_argument_that_exists() -> None:
    """Of a function that takes recordings or files, or of the settings that are named with it."""
    folder = Path(inspect.getfile(Recording)).parents[1]
    assert folder.name == "trainer"
    texts = "\n".join(file.read_text() for file in sorted(folder.rglob("*.py")))
    options = set(re.findall(r"--([a-z][a-z-]*[a-z])", texts))
    assert {"map", "contact-force", "resample-hz", "rest-s"} <= options
    functions = (
        springpot.import_recordings,
        springpot.train,
        FitOptions,
        springpot.record,
        Recording.from_frame,
        springpot.emit,
    )
    for option in options - {"json", "out"}:  # of commands that a message quotes whole
        said = in_python(f"--{option} auto")
        if "`springpot import`" in said:
            continue
        owner, argument = re.fullmatch(r"(?:(\w+)\()?(\w+?)(?:=\S+?)?\)?(?: auto)?", said).groups()
        places = [OWNERS[owner]] if owner else functions
        assert any(argument in inspect.signature(place).parameters for place in places), said
