"""Work-precision of the filter engines and of the coupling's steps, as one picture.

python tests/bench/work_precision.py docs/work-precision.svg
"""

import sys
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from springpot.host.validation.figures import STYLE, svg_text
from springpot.host.wings.evidence.benchmark.figures import draw_curves
from springpot.host.wings.evidence.benchmark.work_precision import work_precision


def main(path: Path) -> None:
    curves = work_precision()
    for family in (line for panel in curves.values() for line in panel.items()):
        print(family[0], ", ".join(f"{p['name']}: {p['time']:.3g}, {p['error']:.2e}"
                                   for p in family[1]))  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        error = "relative error of the half derivative at 2 Hz"
        draw_curves(left, curves["filters"], "whole tick, hot, ns", error)
        steps = "ticks for one second (either: about ten multiplications)"
        draw_curves(right, curves["integrators"], steps, "error of the force, N")
        path.write_text(svg_text(figure))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
