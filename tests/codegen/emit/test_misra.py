"""MISRA C:2012 by cppcheck's addon: the findings in emitted C are those that the docs list."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from support.c import golden_forces
from support.c.single import plan_of, write_single
from support.paths import ROOT

SCENES = (("hammerstein", "off"), ("rf-fd", "proxy"))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="no cppcheck")
def test_findings_are_the_documented_deviations(tmp_path: Path) -> None:
    found: set[str] = set()
    for kind, coupling in SCENES:
        plan = plan_of("soft", golden_forces.model(kind), "float32", coupling)
        source = write_single(plan, tmp_path)
        done = subprocess.run(
            ["cppcheck", "--addon=misra", "--std=c11", "-q", "--template={id}", source.name],
            cwd=tmp_path, capture_output=True, text=True, check=True,
        )  # fmt: skip
        found |= set(re.findall(r"^misra-c2012-([\d.]+)$", done.stderr, re.MULTILINE))
    section = (ROOT / "docs/reference/c.md").read_text().partition("## MISRA C:2012")[2]
    documented = re.findall(r"^\| ([\d., ]+) \|", section, re.MULTILINE)
    assert found == {rule for row in documented for rule in row.split(", ")}
