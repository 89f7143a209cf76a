"""The front page in a browser: figures with ink in them, no console error, at two widths."""

import html
import json
import re
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from support.bench_folder import CANDIDATES, bench_folder
from support.browser import (
    A4_PIXELS,
    CHROMIUM,
    as_printed,
    browse,
    console_errors,
    layout_faults,
)

from springpot.host.wings.evidence.benchmark.labels import label
from springpot.host.wings.evidence.benchmark.point import points_of
from springpot.host.wings.evidence.benchmark.report import (
    bench_page,
    paper_rows,
    write_bench_report,
)
from springpot.host.wings.evidence.benchmark.store import read_result
from springpot.host.wings.evidence.commands.bench import bench_rows
from springpot.host.wings.pages.page import prose

# Where each figure is, and what a mark says when the mouse is over it.
PROBE = """<script>
const boxes = [...document.querySelectorAll("figure svg")].map((svg) => {
  const b = svg.getBoundingClientRect();
  return [b.left, b.top + window.scrollY, b.width, b.height];
});
const marks = [...document.querySelectorAll("#chart .point")];
const first = marks[0].querySelector("path, use");
first.dispatchEvent(new MouseEvent("mousemove", {bubbles: true, clientX: 9, clientY: 9}));
const told = document.getElementById("tip").textContent;
marks[0].dispatchEvent(new MouseEvent("mouseleave"));
const tables = [...document.querySelectorAll(".scroll")];
const wide = Math.max(document.documentElement.scrollWidth, ...tables.map(
  (t) => t.scrollWidth - t.clientWidth + t.getBoundingClientRect().right));
document.body.dataset.probe = JSON.stringify({boxes, marks: marks.length, told, wide});
</script></body>"""


def looked_at(page: Path, width: int) -> tuple[dict[str, Any], np.ndarray]:
    """What the page says of its figures, and the ink (0 white, 1 black) of its screenshot."""
    picture = page.with_suffix(f".{width}.png")
    shown = browse(page, width, f"--screenshot={picture}")
    dumped = browse(page, width, "--dump-dom")
    assert console_errors(shown) == []
    found = re.search(r'data-probe="([^"]*)"', dumped.stdout)
    assert found, "a script of the page failed"
    pixels = matplotlib.image.imread(picture)[..., :3]
    return json.loads(html.unescape(found[1])), 1.0 - pixels.mean(axis=2)


def require_samples(boxes: list[list[float]], ink: np.ndarray) -> None:
    assert len(boxes) == 2
    for left, top, width, height in boxes:
        inside = ink[round(top) : round(top + height), round(left) : round(left + width)]
        assert inside.shape[0] > 150, "a figure is flat"
        assert np.mean(inside > 0.3) > 0.004, "a figure is empty"


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH")
@pytest.mark.parametrize("width", [1280, 800, A4_PIXELS])
def test_the_page_in_a_browser_and_on_paper(tmp_path: Path, width: int) -> None:
    text = write_bench_report(bench_folder()).read_text()
    assert "overflow: visible" in text, "a table that scrolls is cut on paper"
    page = tmp_path / "page.html"
    shown = as_printed(text) if width == A4_PIXELS else text
    page.write_text(shown.replace("</body>", PROBE))
    seen, ink = looked_at(page, width)
    require_samples(seen["boxes"], ink)
    assert seen["marks"] == len(CANDIDATES) - 1
    assert seen["told"].startswith("rf-fd")
    assert "flash" in seen["told"]
    assert seen["wide"] <= width, "the page is wider than the window"


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH")
def test_on_a_phone_nothing_sticks_out_and_no_word_is_cut(tmp_path: Path) -> None:
    text = write_bench_report(bench_folder()).read_text()
    assert layout_faults(text, tmp_path, 400) == {"out": [], "cut": []}


def test_the_page_stands_alone_and_says_why() -> None:
    text = write_bench_report(bench_folder()).read_text()
    result = read_result(bench_folder())
    without_namespaces = re.sub(r'xmlns(:xlink)?="[^"]*"', "", text)
    assert not re.findall(r'(?:src|href)="(?!#)[^"]*"', without_namespaces)
    assert "http" not in without_namespaces
    short = re.search('<p id="summary">.*?</p>', text)
    assert short
    by_key = {point.key: point for point in points_of(result)}
    for name, found in result["picks"].items():
        assert f"--pick {name}" in text
        assert found["budget"]["title"] in short[0]
        assert label(by_key[found["point"]]) in short[0]
        assert str(prose(found["why"])) in text
    for recording in result["recordings"]["training"]:
        assert recording["hash"][:16] in text
    for told in ("126.7 s", "788.3 Hz", "Not comparable", "Left out", "Noise floor"):
        assert told in text


def test_without_the_papers_models_there_is_nothing_to_compare() -> None:
    result = read_result(bench_folder())
    assert {row["kind"] for row in paper_rows(points_of(result))} == {"rf-fd", "rbf-fd", "rbf-pv"}
    kept = [point for point in result["points"] if point["model"] != "rbf-pv"]
    assert paper_rows(points_of({"points": kept})) == []
    assert "nothing to compare" in bench_page(result | {"points": kept}, "bench")


def test_objects_of_a_model_s_own_class_are_told() -> None:
    result = read_result(bench_folder())
    assert 'id="kin"' not in bench_page(result, "bench")
    training = [item | {"source": "sim://dragon-skin-10"}
                for item in result["recordings"]["training"]]  # fmt: skip
    kin = result | {"recordings": {**result["recordings"], "training": training}}
    assert "of the model class of hammerstein itself" in bench_page(kin, "bench")
    assert "sim://bergstrom-boyce" in bench_rows(kin, bench_folder())["judge"]
    assert "judge" not in bench_rows(result, bench_folder())


def test_what_no_hand_may_hold_is_said_first() -> None:
    result = read_result(bench_folder())
    unbounded = [point | {"bounded": False} for point in result["points"]]
    text = bench_page(result | {"points": unbounded}, "bench")
    assert "for simulation only: no hand may hold it" in text
    assert text.count("--accept-unsafe") == 2 * len(result["picks"])
