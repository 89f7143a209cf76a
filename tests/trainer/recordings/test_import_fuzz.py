"""Malformed files: one line that names file and row; no traceback, no silent repair.

`make soak` raises their number by SPRINGPOT_FUZZ.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from support.malformed import DBC, Case, malformed

from springpot.codegen.errors import SpringpotError
from springpot.trainer.recordings.formats.importing import ImportOptions, import_file

COUNT = int(os.environ.get("SPRINGPOT_FUZZ", "100"))
GROUP = 25


def assert_refused(folder: Path, case: Case) -> None:
    file = folder / case.name
    file.write_bytes(case.content)
    (folder / "rig.dbc").write_text(DBC)
    options = ImportOptions(dbc=folder / "rig.dbc" if case.options.get("dbc") else None)
    try:
        import_file(file, None, "none", None, options)
    except SpringpotError as error:
        line = str(error)
        assert "\n" not in line, case.what
        assert str(file) in line, f"{case.what}: {line}"
        assert len(line) < 1000, f"{case.what}: {line}"
        if case.row:
            assert f", row {case.row}" in line, f"{case.what}, row {case.row}: {line}"
        return
    assert not case.surely, f"{case.what}: taken for good"


@pytest.mark.parametrize("group", range(-(-COUNT // GROUP)))
def test_malformed_files_are_refused_in_one_line(tmp_path: Path, group: int) -> None:
    for seed in range(group * GROUP, (group + 1) * GROUP):
        assert_refused(tmp_path, malformed(np.random.default_rng(seed)))
