"""The README's figures and docs/results.md are what the stored benchmark says."""

import json
import re
import runpy

from support.paths import BENCH

SCRIPT = runpy.run_path(str(BENCH / "results.py"))


def stored() -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads(SCRIPT["STORED"].read_text())
    return found


def test_the_pages_are_written_from_the_benchmark() -> None:
    for path, text in SCRIPT["pages"](stored()).items():
        if path.suffix == ".svg":  # its curves are the library's of drawing, in its version
            assert re.findall("<title>.*", path.read_text()) == re.findall("<title>.*", text)
        else:
            assert path.read_text() == text, f"{path}: run python tests/bench/results.py"


def test_a_changed_figure_shows() -> None:
    results = stored()
    results[0]["points"][0]["rmse_n"] *= 2.0  # type: ignore[index]
    front = [p for p in results[0]["points"] if p["pareto"]]  # type: ignore[attr-defined]
    front[0]["tick_ns_hot"] *= 3.0
    changed = SCRIPT["pages"](results)
    assert changed[SCRIPT["ROOT"] / "docs" / "results.md"] != SCRIPT["results_page"](stored())
    assert "in 2 s" in SCRIPT["readme_results"](results[0] | {"cpu_s": 2.0})
