"""The core without host/wings: it still records, trains, emits, runs, validates."""

import subprocess
import sys
from pathlib import Path

# A finder before all others that knows no module below springpot.host.wings.
HIDING = """
import sys
from importlib.abc import MetaPathFinder

class Hidden(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.startswith("springpot.host.wings"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Hidden())
from springpot.host.cli import main
main()
"""
SCENE = 'schema = 1\nname = "pad"\nmodel = "pad.spm"\n'
PROTOCOL = """
[[profile]]
amplitude_n = 6.0
frequency_hz = 1.0
cycles = 2
[[profile]]
amplitude_n = 4.0
frequency_hz = 2.0
cycles = 3
"""
OF_WINGS = ("study", "identify", "place", "bench", "reproduce", "page", "material")


def run(folder: Path, *words: str, status: int = 0) -> subprocess.CompletedProcess[str]:
    result = subprocess.run([sys.executable, "-c", HIDING, *words], cwd=folder, check=False,
                            capture_output=True, text=True)  # fmt: skip
    assert result.returncode == status, result.stderr
    assert "Traceback" not in result.stderr
    return result


def test_the_core_does_its_whole_job_without_wings(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "presses.toml").write_text(PROTOCOL)
    device = "sim://ecoflex-00-30"
    run(tmp_path, "record", "--device", device, "--protocol", "presses.toml", "--out", "rec")
    run(tmp_path, "export", "rec", "--to", "csv", "--out", "csv")
    csv = next((tmp_path / "csv").glob("*.csv"))
    run(tmp_path, "import", str(csv), "--out", "again")
    run(tmp_path, "check", "rec")
    run(tmp_path, "train", "rec", "--model", "hammerstein", "--out", "pad.spm")
    run(tmp_path, "emit", "--scene", "scene.toml", "--out", "c")
    run(tmp_path, "stability", "--scene", "scene.toml")
    run(tmp_path, "run", "--scene", "c", "--device", device, "--seconds", "0.3", "--log", "felt.h5")
    run(tmp_path, "validate", "c", "--recording", "felt.h5")
    run(tmp_path, "validate", "c", "--recording", "again")


def test_commands_and_options_of_wings_are_not_there_without_them(tmp_path: Path) -> None:
    listed = run(tmp_path, "--help").stdout
    commands = [
        line.split()[0]
        for line in listed.splitlines()
        if line.startswith("  ") and line[2:3].isalpha()
    ]
    assert not set(OF_WINGS) & set(commands)
    refused = run(tmp_path, "train", "none", "--model", "springpot", "--out", "x.spm", status=2)
    assert "'springpot' is not one of" in refused.stderr
    for words in (("record", "--device", "sim://ecoflex-00-30", "--protocol", "paper",
                   "--force", "serial:///dev/none", "--out", "x"),
                  ("emit", "--pick", "pc-1khz", "--out", "c")):  # fmt: skip
        assert "not installed here" in run(tmp_path, *words, status=2).stderr
