"""Figure 17 of the paper: the force that one person felt over the depth, by condition."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np

from springpot import SpringpotError, read_recordings
from springpot.basics import Samples
from springpot.figures import ERROR, STYLE, stride, svg_text
from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.report.comparisons import Row
from springpot.host.wings.study.report.figures import clear_figure
from springpot.host.wings.study.report.scores import condition_title
from springpot.host.wings.study.responses import Response

_MAX_PANELS = 24
_BREAK = np.array([np.nan])


class FeltLoops:
    """Presses of the person with most logged trials: depths and forces in contact, by condition.

    missing: logs that could not be read, and why the first could not."""

    def __init__(self, study: Study, responses: Sequence[Response]) -> None:
        logged = [r for r in responses if r.log is not None and r.session > 0]
        people = [r.participant for r in logged]
        self.participant = max(dict.fromkeys(people), key=people.count) if people else ""
        self.conditions: dict[str, tuple[Samples, Samples]] = {}
        self.missing: list[str] = []
        parts: dict[str, list[tuple[Samples, Samples]]] = {}
        for response in logged:
            if response.participant != self.participant:
                continue
            assert response.log is not None
            try:
                recording = read_recordings(response.log)[0]
            except SpringpotError as error:
                self.missing.append(str(error))
                continue
            felt = (recording.position_m > 0.0) & (recording.force_n != 0.0)
            if np.any(felt):
                depth = np.where(felt, recording.position_m, np.nan)
                force = np.where(felt, recording.force_n, np.nan)
                title = condition_title(study, response.pair)
                parts.setdefault(title, []).append((depth, force))
        for title in dict.fromkeys(condition_title(study, k) for k in range(len(study.pair))):
            presses = parts.get(title, [])
            if not presses:
                continue
            depth, force = (
                np.concatenate([x for press in presses for x in (press[k], _BREAK)]) for k in (0, 1)
            )
            self.conditions[title] = depth, force

    def rows(self) -> list[Row]:
        """Return deepest, hardest, and the work that a loop keeps, by condition."""
        return [
            {
                "participant": self.participant,
                "condition": title,
                "deepest_m": float(np.nanmax(depth)),
                "hardest_n": float(np.nanmax(force)),
                "stiffness_npm": float(np.nanmax(force) / np.nanmax(depth)),
                "samples": int(np.sum(np.isfinite(depth))),
            }
            for title, (depth, force) in self.conditions.items()
        ]

    def figure(self) -> str:
        """Return SVG text: small multiples on one scale."""
        shown = list(self.conditions.items())[:_MAX_PANELS]
        columns = min(4, len(shown))
        rows = -(-len(shown) // columns)
        with mpl.rc_context(STYLE):
            figure = clear_figure(max(4.0, 2.1 * columns), 1.9 * rows + 0.3)
            panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
            for axes in np.ravel(panels)[len(shown) :]:
                axes.set_visible(False)
            for axes, (title, (depth, force)) in zip(np.ravel(panels), shown, strict=False):
                axes.patch.set_alpha(0.0)
                every = stride(len(depth), 6000)
                axes.plot(1e3 * depth[::every], force[::every], color=ERROR, lw=0.5)
                axes.set_title(title, fontsize=7.5)
            figure.supxlabel("depth, mm", fontsize=9)
            figure.supylabel("force, N", fontsize=9)
            return svg_text(figure)
