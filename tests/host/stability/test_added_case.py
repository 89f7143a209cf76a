"""The line that the how-to gives for a case of the closed loop is a case, where it says."""

import re
from dataclasses import fields
from typing import Any

import numpy as np
from support.paths import ROOT
from support.small import passive_model

from springpot.codegen.coupling.linear_loop import DESIGN_HAND
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Scene
from springpot.host.simulation.scenarios import Case

PAGE = (ROOT / "docs" / "how-to" / "extend.md").read_text(encoding="utf-8")
SECTION = PAGE.partition("## A case of the stability check\n")[2]


def added(line: str) -> tuple[list[Case], list[Case]]:
    """Cases without the line and with it, at the end of the list that the named file returns."""
    (path,) = re.findall(r"`cases` of\s+\[\w+\.py\]\(\.\./\.\./(\S+)\)", SECTION)
    source = (ROOT / path).read_text(encoding="utf-8")
    before, at, after = source.partition("\n    ]\n\n")
    found = []
    for text in (source, f"{before}\n        {line},{at}{after}"):
        scope: dict[str, Any] = {"__name__": __name__}
        exec(compile(text, path, "exec"), scope)
        plan = make_plan(passive_model(), Scene(schema=1, name="x", model="x"))
        found.append(
            scope["cases"](plan, lambda depth_m: 1e3 * np.maximum(depth_m, 0), DESIGN_HAND)
        )
    return found[0], found[1]


def test_the_line_of_the_page_adds_one_case() -> None:
    (line,) = re.findall(r"`(Case\(.*\))`", SECTION)
    before, after = added(line)
    names = [case.name for case in after]
    assert names[:-1] == [case.name for case in before]
    assert names[-1] not in names[:-1]
    scenario = after[-1].scenario
    seconds = float(re.findall(r"(\d+) s of a motion", SECTION)[0])
    assert np.isclose(scenario.dt_s.sum(), seconds)
    assert np.ptp(scenario.intended_m) > 0


def test_the_page_names_fields_that_a_case_has() -> None:
    (sentence,) = re.findall(r"The fields of `Case` say[^.]*\.", SECTION)
    named = set(re.findall(r"`([a-z_]+)`", sentence))
    assert named
    assert named <= {field.name for field in fields(Case)}
