"""The README's figures and docs/explanation/results.md are what the stored benchmarks say."""

import re
import runpy
import sys

from support.paths import BENCH

sys.path.append(str(BENCH))  # as where the script is run
SCRIPT = runpy.run_path(str(BENCH / "results.py"))


def test_the_pages_are_written_from_the_benchmark() -> None:
    for path, text in SCRIPT["stored_pages"]().items():
        if path.suffix == ".svg":  # its curves are the library's of drawing, in its version
            shown = "<!-- .* % -->|<title>.*"  # the words of a text are a comment beside its curves
            assert re.findall(shown, path.read_text()) == re.findall(shown, text)
        else:
            assert path.read_text() == text, f"{path}: run python tests/bench/results.py"
