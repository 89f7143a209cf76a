"""What Python says names arguments, and no options of the command line."""

import pytest

from springpot.host.console.in_python import in_python


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
