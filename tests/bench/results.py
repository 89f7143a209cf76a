"""Write docs/explanation/results.md, its pictures and the README's figures from benchmarks.

    springpot record --device sim://ecoflex-00-30 --protocol paper --out training
    springpot record --device sim://ecoflex-00-30 --protocol validation --seed 1 --out validation
    springpot bench --recording training --validate validation --out bench
    springpot import Dynamic_data.txt --zero min --out m1    # one's own recordings, beside it
    springpot bench --recording m1 --out mach1
    python tests/bench/judges.py judges --mach1 Dynamic_data.txt
    python tests/bench/wasm.py training validation --out wasm.json
    python tests/bench/results.py bench/bench.json mach1/bench.json judges/judges.json wasm.json

On a machine with nothing else to do: times are upper bounds otherwise, and the page says so. Real
recordings come first, then foreign objects, the five silicones, hammerstein's kin, last. What is
not given is taken from docs/results.json, judges.json and wasm.json, which keep what the pages
need. No figure in either page is typed by hand:
tests/wings/evidence/benchmark/test_results.py compares.
"""

import json
import sys
from pathlib import Path
from typing import Any

from front_page import bars_figure, sentence
from judges_table import judges_section
from wasm import wasm_section

from springpot.host.metrics import JND_WORDS, floor_words
from springpot.host.simulation.objects import FOREIGN_OBJECTS, own_class
from springpot.host.wings.evidence.benchmark.figures import front_figure
from springpot.host.wings.evidence.benchmark.labels import kilobytes, label
from springpot.host.wings.evidence.benchmark.point import Point, points_of
from springpot.host.wings.evidence.benchmark.report import paper_rows, plain

Metadata = dict[str, Any]
ROOT = Path(__file__).parents[2]
STORED = ROOT / "docs" / "results.json"
STORED_JUDGES = ROOT / "docs" / "judges.json"
STORED_WASM = ROOT / "docs" / "wasm.json"
BEGIN, END = "<!-- results: written by tests/bench/results.py -->", "<!-- results end -->"
_KEPT = ("picks", "machine", "compiler", "flags", "target", "rate_hz", "seed", "command",
         "wall_s", "cpu_s", "computed", "load")  # fmt: skip
_POINT = ("key", "model", "options", "rmse_n", "rmse_percent_of_peak", "mean_recording_rmse_n",
          "mean_recording_rmse_interval_n", "ape_below_jnd", "error_per_jnd", "cv_rmse_n",
          "tick_ns_hot", "tick_ns_p99", "tick_ns_p999", "instructions", "flash_bytes",
          "ram_bytes", "feature_s", "fit_s", "active_cells", "cells", "bounded",
          "worst_fidelity_percent", "pareto")  # fmt: skip


def condensed(result: Metadata) -> Metadata:
    """What the pages need of one benchmark."""
    training, validation = (result["recordings"][name] for name in ("training", "validation"))
    kept = {name: result[name] for name in _KEPT}
    return kept | {
        "name": source(training[0]["source"]),
        "training": len(training),
        "validation": len(validation),
        "quality": {"noise_floor_n": result["quality"]["noise_floor_n"]},
        "validation_floor": result["validation_floor"],
        "points": [{name: point[name] for name in _POINT} for point in result["points"]],
    }


def source(text: str) -> str:
    """Where recordings came from, without the path."""
    if text.startswith("sim://"):
        return "simulated " + text.removeprefix("sim://").split("?")[0]
    name = Path(text.split(",", maxsplit=1)[0].split(" ", maxsplit=1)[0]).name
    return {"Dynamic_data.txt": "Mach-1 tester (Dynamic_data.txt)"}.get(name, name)


_KIN = 2


def kinship(result: Metadata) -> int:
    """Order of a benchmark: real recordings, foreign objects, those of hammerstein's own class."""
    name = result["name"].removeprefix("simulated ")
    return _KIN if own_class(f"sim://{name}") else int(name in FOREIGN_OBJECTS)


def pages(results: list[Metadata], judges: Metadata) -> dict[Path, str]:
    """Every file that is written, with its content."""
    benches = sorted(results, key=kinship)
    written = {
        ROOT / "docs" / f"pareto-{i + 1}.svg": front_figure(result) + "\n"
        for i, result in enumerate(benches)
    }
    written[ROOT / "docs" / "bars.svg"] = bars_figure(judges) + "\n"
    written[ROOT / "docs" / "explanation" / "results.md"] = results_page(benches, judges)
    written[ROOT / "README.md"] = readme(benches, judges)
    return written


def results_page(benches: list[Metadata], judges: Metadata) -> str:
    """docs/explanation/results.md."""
    parts = [
        "# Error against run time, measured\n",
        "Written by `python tests/bench/results.py` from the JSON of `springpot bench`, kept in "
        "[results.json](../results.json), of judges.py, kept in "
        "[judges.json](../judges.json), and of wasm.py, kept in [wasm.json](../wasm.json); no "
        "figure is typed by hand.\n",
        *judges_section(judges),
    ]
    for i, result in enumerate(benches):
        parts += section(result, f"../pareto-{i + 1}.svg")
    parts += wasm_section(json.loads(STORED_WASM.read_text()))
    return "\n".join(parts)


def section(result: Metadata, picture: str) -> list[str]:
    """One data set."""
    points = points_of(result)
    front = sorted((p for p in points if p.pareto), key=lambda p: p.tick_ns_hot)
    parts = [
        f"## {result['name'][:1].upper()}{result['name'][1:]}\n",
        *([KIN] if kinship(result) == _KIN else []),
        f"`{result['command']}`: {len(result['points'])} points of "
        f"{len({p.model for p in points})} kinds, {result['training']} training and "
        f"{result['validation']} validation recordings at {plain(result['rate_hz'], 6)} Hz; "
        f"{result['cpu_s']:.0f} s of processor time{elapsed(result)}. {result['machine']}; "
        f"{result['compiler']}, `{result['flags']}`; load average {result['load']:.1f} before it "
        "began, and times are upper bounds where that is not 0.\n",
        f"![Error against the time of a tick; the front is marked]({picture})\n",
        "| budget | pick | why |\n| --- | --- | --- |",
        *(pick_row(result, found) for found in result["picks"].values()),
        "\nThe front:\n",
        table(front, result["target"], result["validation_floor"]["noise_floor_n"]),
        f"\nNoise floor of the validation recordings: {floor_words(result['validation_floor'])}. "
        f"JND: {JND_WORDS}.\n",
    ]
    if rows := paper_rows(points):
        parts += ["\nThe paper's models beside the paper:\n", paper_table(rows), NOT_COMPARABLE]
    return parts


KIN = "This object is of the model class of `hammerstein` itself, which it flatters.\n"
NOT_COMPARABLE = (
    "\nNot comparable: the paper's figure 9 prints bars of five real silicones, its figure 10 is "
    "MATLAB with RBF software that it does not name, and its table 3 counts a whole haptic thread "
    "with device; here a rate is one tick's computing in a tight loop.\n"
)


def elapsed(result: Metadata) -> str:
    """Time on the clock, of a benchmark that was not resumed."""
    whole = result["computed"] == len(result["points"])
    return f" in {result['wall_s']:.0f} s on the clock" if whole else ""


def pick_row(result: Metadata, found: Metadata) -> str:
    """A row of the picks."""
    chosen = next((p for p in points_of(result) if p.key == found["point"]), None)
    name = label(chosen) if chosen else "none"
    return f"| {found['budget']['title']} | {name} | {found['why']} |"


def table(points: list[Point], target: str, floor_n: float | None) -> str:
    """Points, one a row."""
    head = (
        "| model | RMSE, N | % of peak | / noise floor | / JND | tick, µs | "
        f"flash, {target} | RAM, bytes | fit, s | active cells |\n" + "| --- " * 10 + "|"
    )
    rows = [
        f"| {label(p)} | {plain(p.rmse_n)} | {plain(p.rmse_percent_of_peak, 2)} | "
        f"{plain(p.rmse_n / floor_n, 2) if floor_n else '–'} | "
        f"{'–' if p.error_per_jnd is None else plain(p.error_per_jnd, 2)} | "
        f"{plain(1e-3 * p.tick_ns_hot, 2)} | {kilobytes(p.flash_bytes)} | {p.ram_bytes} | "
        f"{plain(p.fit_s, 2)} | {p.active_cells} of {p.cells} |"
        for p in points
    ]
    return "\n".join([head, *rows])


def paper_table(rows: list[dict[str, str]]) -> str:
    """The claims of figures 9, 10 and table 3."""
    head = (
        "| model | RMSE | of rbf-pv's | modelling, paper | here | | rate, paper | here | |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    )
    lines = [
        f"| {r['kind']} | {r['rmse']} | {r['rmse_ratio']} | {r['fit_paper']} | {r['fit']} | "
        f"{r['fit_ratio']} | {r['rate_paper']} | {r['rate']} | {r['rate_ratio']} |"
        for r in rows
    ]
    return "\n".join([head, *lines])


def readme(benches: list[Metadata], judges: Metadata) -> str:
    """The README with its results between the two marks."""
    text = (ROOT / "README.md").read_text()
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    parts = ["![Error of springpot, the paper's forest, a spring and a dashpot](docs/bars.svg)"]
    parts.append(sentence(benches, judges))
    return "\n".join([f"{before}{BEGIN}", "\n\n".join(parts), f"{END}{after}"])


def stored_pages() -> dict[Path, str]:
    """`pages` of what docs/ keeps."""
    return pages(json.loads(STORED.read_text()), json.loads(STORED_JUDGES.read_text()))


def main(given: list[Path]) -> None:
    found = [json.loads(path.read_text()) for path in given]
    if benches := [condensed(result) for result in found if "points" in result]:
        STORED.write_text(json.dumps(benches, indent=1) + "\n")
    for judges in (result for result in found if "cells" in result):
        STORED_JUDGES.write_text(json.dumps(judges, indent=1) + "\n")
    for wasm in (result for result in found if "wasm" in result):
        STORED_WASM.write_text(json.dumps(wasm, indent=1) + "\n")
    for path, text in stored_pages().items():
        path.write_text(text)


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]])
