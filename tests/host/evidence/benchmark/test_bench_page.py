"""The page of a benchmark: its points, its words, and how it looks in a browser."""

import html
import json
import re
from pathlib import Path

import pytest
from support.bench_folder import CANDIDATES, bench_folder
from support.browser import (
    A4_PIXELS,
    NEEDS_CHROMIUM,
    as_printed,
    browse,
    console_errors,
    layout_faults,
)

from springpot.host.evidence.benchmark.labels import label
from springpot.host.evidence.benchmark.point import points_of
from springpot.host.evidence.benchmark.report import (
    bench_page,
    paper_rows,
    write_bench_report,
)
from springpot.host.evidence.benchmark.store import read_result
from springpot.host.evidence.commands.bench import bench_rows
from springpot.host.pages.page import prose

# How high each figure is, and what a mark says when the mouse is over it.
PROBE = """<script>
const heights = [...document.querySelectorAll("figure svg")].map(
  (svg) => svg.getBoundingClientRect().height);
const marks = [...document.querySelectorAll("#chart .point")];
const first = marks[0].querySelector("path, use");
first.dispatchEvent(new MouseEvent("mousemove", {bubbles: true, clientX: 9, clientY: 9}));
const told = document.getElementById("tip").textContent;
marks[0].dispatchEvent(new MouseEvent("mouseleave"));
document.body.dataset.probe = JSON.stringify({heights, marks: marks.length, told});
</script></body>"""


@NEEDS_CHROMIUM
def test_every_point_is_drawn_and_says_what_it_is(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(write_bench_report(bench_folder()).read_text().replace("</body>", PROBE))
    shown = browse(page, 1280, "--dump-dom")
    assert console_errors(shown) == []
    found = re.search(r'data-probe="([^"]*)"', shown.stdout)
    assert found, "a script of the page failed"
    seen = json.loads(html.unescape(found[1]))
    assert len(seen["heights"]) == 2
    assert min(seen["heights"]) > 150
    assert seen["marks"] == len(CANDIDATES) - 1
    assert seen["told"].startswith("rf-fd")
    assert "flash" in seen["told"]


@NEEDS_CHROMIUM
@pytest.mark.parametrize("width", [400, 800, 1280, A4_PIXELS])
def test_nothing_sticks_out_on_screens_and_paper(tmp_path: Path, width: int) -> None:
    text = write_bench_report(bench_folder()).read_text()
    shown = as_printed(text) if width == A4_PIXELS else text
    assert layout_faults(shown, tmp_path, width) == {"out": [], "cut": []}


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
