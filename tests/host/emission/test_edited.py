"""C that is not what was emitted is named wherever it runs: a warning, in results and logs."""

import json
import re
import shutil
from pathlib import Path

import pytest
from support.in_process import spring

from springpot.host.emission.checksums import edited_files
from springpot.host.emission.emission import read_emission
from springpot.trainer.recordings.recording_file import read_recording

pytestmark = pytest.mark.filterwarnings("always::UserWarning")


@pytest.fixture(scope="module")
def emitted(job: Path) -> Path:
    return job / "c"


@pytest.fixture
def folder(emitted: Path, tmp_path: Path) -> Path:
    """A copy to edit."""
    return shutil.copytree(emitted, tmp_path / "c")


def raise_the_clamp(folder: Path) -> None:
    """A thousand times the force that the recordings say."""
    source = folder / "sp.c"
    text = source.read_text()
    raised, places = re.subn(
        r"([\d.]+)f(?=, +/\* max_n \*/)", lambda found: f"{1e3 * float(found[1])}f", text
    )
    assert places == 1
    source.write_text(raised)


def commands(folder: Path, press_file: Path) -> dict[str, list[str]]:
    """What runs an emitted folder."""
    return {
        "build": ["build", str(folder)],
        "validate": ["validate", str(folder), "--recording", str(press_file)],
        "run": ["run", "--scene", str(folder), "--device", "sim://ecoflex-00-30",
                "--seconds", "0.05", "--log", str(folder.parent / "felt.h5")],
        "firmware": ["firmware", "--scene", str(folder), "--board", "mps2-an386",
                     "--out", str(folder.parent / "fw")],
    }  # fmt: skip


def test_an_edit_is_named_in_a_warning_result_log_and_report(folder: Path, emitted: Path) -> None:
    raise_the_clamp(folder)
    asked = commands(folder, emitted.parent / "press.h5")
    found = {}
    for name in ("build", "validate", "run"):
        done = spring(*asked[name], "--json")
        assert done.returncode == 0, done.stderr
        assert f"warning: {folder}/sp.c: not as springpot emitted it" in done.stderr
        found[name] = json.loads(done.stdout)
        assert found[name]["edited"] == ["sp.c"]
    said = read_recording(folder.parent / "felt.h5").details["session"]
    assert said["edited"] == ["sp.c"]
    # Neither a board nor a log of the C that was emitted is taken for one of these.
    assert found["run"]["hash"] == found["validate"]["hash"] == said["hash"]
    assert said["hash"] != read_emission(emitted).hash and spring("report", folder).returncode == 0
    page = (folder / "report.html").read_text()
    assert "This C is not what springpot emitted: sp.c" in page
    (folder / "sp.h").write_text("/* another change */\n" + (folder / "sp.h").read_text())
    again = spring("report", folder)
    assert again.returncode == 3 and "changed since it was validated" in again.stderr
    rows = spring(*asked["validate"]).stdout
    assert "sp.c, sp.h" in rows


@pytest.mark.parametrize(
    ("name", "what"),
    [("sp.c", "missing"), ("from/model.spm", "missing"), ("from/files.json", "missing"),
     ("from/files.json", "not as springpot emitted it"),
     ("stdbool.h", "not as springpot emitted it"),  # compiled in the system's place
     ("bits/mine.h", "not as springpot emitted it"),
     ("bits", "not as springpot emitted it")],  # a link: what is behind it is not listed
)  # fmt: skip
def test_missing_changed_and_additional_files(folder: Path, name: str, what: str) -> None:
    file = folder / name
    if what == "missing":
        file.unlink()
    elif name == "bits":
        file.symlink_to(folder.parent)
    else:
        file.parent.mkdir(exist_ok=True)
        file.write_text("{}" if name.endswith("json") else "#include <stddef.h>\n")
    with pytest.warns(UserWarning, match=f"{file}: {what}"):
        edited_files(folder)


def test_the_library_built_before_is_not_taken_for_edited_c(folder: Path) -> None:
    built, hashes = set(), set()
    for _ in range(3):  # as emitted, edited, and the same file edited again
        built.add(spring("build", folder).stdout)
        hashes.add(read_emission(folder).hash)
        raise_the_clamp(folder)
    assert len(built) == len(hashes) == 3
