"""The core without host/wings: it still records, trains, emits, runs, validates."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.small import model_file, press, recording

from springpot import write_recording
from springpot.native import missing_tools

WASM_LACKS = missing_tools("wasm32")

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
OF_WINGS = ("study", "identify", "place", "bench", "reproduce", "page", "material", "doctor",
            "demo", "report", "firmware", "completion",
            "export", "predict")  # fmt: skip
FOREIGN = {  # how files of formats begin that only a wing reads
    "x.mat": b"MATLAB 5.0 MAT-file, made by hand\0\1\2",
    "x.h5": b"\x89HDF\r\n\x1a\n" + bytes(600),
    "x.xlsx": b"PK\x03\x04" + bytes(60),
    "x.tdms": b"TDSm" + bytes(60),
    "x.txt": b"<Mach-1 File>\n<INFO>\n<END INFO>\n",
    "x.log": b"(1.000000) can0 123#0011\n(1.001000) can0 123#0012\n",
}


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
    pad = recording("pad", press(1.0))
    time_s = pad.dt_s * np.arange(len(pad.force_n))
    rows = np.column_stack([time_s, pad.position_m, pad.force_n])
    np.savetxt(tmp_path / "again.csv", rows, "%.9g", ",", comments="",
               header="time_s,position_m,force_N")  # fmt: skip
    run(tmp_path, "import", "again.csv", "--out", "again")
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


def test_public_names_of_wings_are_one_line_without_them(tmp_path: Path) -> None:
    for name in ("springpot.PositionRegressor", "springpot.native.run_batch",
                 "springpot.figures.PageServer", "springpot.devices.can_database"):  # fmt: skip
        module, _, public = name.rpartition(".")
        script = HIDING.replace("from springpot.host.cli import main\nmain()",
                                f"from {module} import {public}")  # fmt: skip
        result = subprocess.run([sys.executable, "-c", script], check=False, cwd=tmp_path,
                                capture_output=True, text=True)  # fmt: skip
        told = result.stderr.strip().splitlines()[-1]
        assert told.startswith(f"ImportError: {name}: this part of springpot is not installed here")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings, a model and its scene, with all of springpot."""
    folder = tmp_path_factory.mktemp("made")
    write_recording(folder / "press.h5", recording("press", press(2.0)))
    model_file(folder).rename(folder / "pad.spm")
    (folder / "scene.toml").write_text(SCENE)
    rows = "".join(f"{i / 1000},{i % 7},{i % 7}\n" for i in range(100))
    (folder / "press.csv").write_text(f"time_s,position_mm,force_n\n{rows}")
    (folder / "wasm.toml").write_text(f'{SCENE}[runtime]\ntarget = "wasm32"\n')
    for name, content in FOREIGN.items():
        (folder / name).write_bytes(content)
    return folder


def require_line(folder: Path, words: str, status: int, told: str) -> None:
    """Refused in one line, which says what is not there."""
    assert told in run(folder, *words.split(), status=status).stderr.strip().splitlines()[-1]


@pytest.mark.parametrize(
    "words",
    [
        "train press.h5 --model rf-fd --within 1% --out x.spm",
        "train press.h5 --model hammerstein --next x.toml --out x.spm",
        "emit --scene scene.toml --single --out c",
        "import press.csv --tare auto --out r",
        pytest.param(
            "emit --scene wasm.toml --out c",
            marks=pytest.mark.skipif(bool(WASM_LACKS), reason=WASM_LACKS),
        ),
        "run --scene scene.toml --device sim://free --log felt.h5",
    ],
)
def test_an_option_of_a_wing_is_one_line_without_it(made: Path, words: str) -> None:
    told = "of springpot is not installed here: install all of springpot"
    require_line(made, words, 2, told)


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_of_a_format_that_is_not_there_is_one_line(made: Path, name: str) -> None:
    told = "; not installed here: can-log, hdf5, mach-1, mat, tdms, workbook; to have them, install"
    require_line(made, f"import {name} --out rec", 3, told)


@pytest.mark.parametrize("url", ["odrive://slcan//dev/none?node=0", "dhd://", "serial:///dev/none"])
def test_a_device_that_is_not_there_is_one_line(made: Path, url: str) -> None:
    told = "; not installed here: dhd, odrive, serial; to have them"
    require_line(made, f"run --scene scene.toml --device {url}", 5, told)


def test_what_to_record_next_is_not_said_without_its_wing(made: Path) -> None:
    result = run(made, "train", "press.h5", "--model", "hammerstein", "--json", "--out", "y.spm")
    assert "next_presses" not in json.loads(result.stdout)
