"""Whether the tests notice every change of the Python that reads files and starts devices.

python tests/proof/mutation/mutate_python.py OUT.json [--only NAME] [--workers N]

"""

import json
import os
import subprocess
import sys
from pathlib import Path

from killing import ROOT, SURVIVED, UNCHANGED, parse_options, try_all
from mutants_python import mutants_of_python, same_program
from survivors import write_result

_SCENE = ("tests/host/emission/test_scene_keys.py",)
_MODEL = (
    "tests/codegen/model/test_model_limits.py",
    "tests/codegen/model/test_packed_arrays.py",
    "tests/codegen/model/test_model_header.py",
    "tests/codegen/model/test_hostile_models.py::test_what_would_be_refused_is_not_written",
)
_RECORDING = (
    "tests/host/api/test_tables.py",
    "tests/trainer/recordings/test_recording_file.py",
    "tests/trainer/recordings/test_recording_names.py",
    "tests/trainer/recordings/test_hostile_files.py::"
    "test_hdf5_without_our_checksum_is_read_in_a_process_of_its_own",
    "tests/trainer/recordings/test_journal.py",
)
_JOURNAL = ("tests/trainer/recordings/test_journal.py",)
_ODRIVE = (
    "tests/wings/devices/test_odrive_start.py",
    "tests/wings/devices/test_odrive.py::test_wrong_urls_are_one_line",
)
_SERIAL = (
    "tests/wings/devices/test_serial_start.py",
    "tests/wings/devices/test_serial_port.py",
)
_URL = ("tests/host/devices/test_device_url.py",)
# Test files, or tests, that may catch the mutants of a file, the likeliest first: quick ones.
TESTS = {
    "codegen/scene.py": _SCENE,
    "host/emission/scene_file.py": _SCENE,
    "codegen/plan/limits.py": (
        "tests/codegen/plan/test_limits.py",
        "tests/codegen/plan/test_plan.py",
    ),
    "host/devices/url.py": _URL,
    "host/devices/device.py": (
        "tests/host/devices/test_sample_rate.py",
        "tests/host/devices/test_requirements.py",
    ),
    "trainer/recordings/recording.py": _RECORDING,
    "trainer/recordings/recording_file.py": _RECORDING,
    "trainer/recordings/recording_hdf5.py": _RECORDING,
    "trainer/recordings/journal_blocks.py": _JOURNAL,
    "trainer/recordings/journal_reader.py": ("tests/trainer/recordings/test_journal_reader.py",),
    "codegen/model/packed_arrays.py": _MODEL,
    "codegen/model/field_types.py": _MODEL,
    "codegen/model/validity.py": _MODEL,
    "codegen/model/model_file.py": _MODEL,
    "host/wings/devices/odrive.py": _ODRIVE,
    "host/wings/devices/odrive_device.py": _ODRIVE,
    "host/wings/devices/serial_port.py": _SERIAL,
    "host/wings/devices/serial_device.py": _SERIAL,
}
_OPTIONS = [
    "-q", "-x", "--assert=plain", "-o", "addopts=", "-p", "no:xdist", "-p", "no:cacheprovider",
    "-m", "not long and not realtime and not board",
]  # fmt: skip
# Of files that are given whole: seconds each, and none that others do not catch sooner.
_SLOW = (
    "tests/trainer/recordings/test_journal.py::test_killed_while_recording",
    "tests/trainer/recordings/test_journal.py::test_two_writers",
    "tests/trainer/recordings/test_recording_file.py::test_round_trip",
)
_DESELECTED = [word for test in _SLOW for word in ("--deselect", test)]
_servers: dict[Path, "subprocess.Popen[str]"] = {}


def _server(copy: Path) -> "subprocess.Popen[str]":
    if copy not in _servers:
        environment = {
            **os.environ,
            "PYTHONPATH": str(copy / "build" / "ns"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        program = Path(__file__).parent / "forked_tests.py"
        _servers[copy] = subprocess.Popen(
            [sys.executable, str(program)],
            cwd=copy, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
    return _servers[copy]


def passes(copy: Path, test: str) -> bool:
    """Whether a file of tests passes in a copy of the checkout."""
    server = _server(copy)
    server.stdin.write(json.dumps([*_OPTIONS, *_DESELECTED, test]) + "\n")
    server.stdin.flush()
    return server.stdout.readline().strip() == "0"


def _attempt(copy: Path, file: str, text: str) -> str:
    original = (ROOT / file).read_text()
    if text != original:
        if same_program(original, text):
            return UNCHANGED
        (copy / file).write_text(text)
    return next((test for test in TESTS[file] if not passes(copy, test)), SURVIVED)


def main() -> int:
    options = parse_options(TESTS)
    record = ROOT / "build" / "mutation" / "python.jsonl"
    tried = try_all(record, options.files, mutants_of_python, _attempt, options.workers)
    for server in _servers.values():
        server.terminate()
    command = "python tests/proof/mutation/mutate_python.py OUT.json"
    title = "Mutation of the Python that reads files and starts devices"
    return int(write_result(options.out, title, command, tried) > 0)


if __name__ == "__main__":
    sys.exit(main())
