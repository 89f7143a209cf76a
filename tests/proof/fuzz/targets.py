"""A target's process: built or started, started again after what ends it, and what it counts."""

import importlib
import os
import re
import resource
import shutil
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from support.paths import ROOT

from springpot.host.native.c_library import declarations

MAX_S, MAX_MIB, MAX_INPUT = 10, 1024, 1 << 20
_HERE = Path(__file__).parent
_PORT = ROOT / "runtime_c" / "port"
_STARTED_S = 20  # python, its libraries and instrumentation
_COVERAGE = re.compile(r"#\d+\s+(INITED|DONE|pulse|NEW|REDUCE|RELOAD)\s+cov: (\d+)")
_RUNS = re.compile(r"stat::number_of_executed_units: (\d+)")
_RSS = re.compile(r"stat::peak_rss_mb:\s+(\d+)")


def missing_for(name: str) -> str | None:
    """What to install for a target, where it is not there."""
    if name == "wire":
        return None if shutil.which("clang") else "no clang: `apt-get install clang`"
    return None if find_spec("atheris") else "no atheris: `pip install atheris`"


def prepare(name: str, folder: Path) -> list[str]:
    """Seeds and dictionary written, C built; the command without libFuzzer's options."""
    for part in ("seeds", "corpus", "findings"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    if name == "wire":
        return [str(_built(folder / "fuzz_wire_bytes"))]
    reader = importlib.import_module(f"proof.fuzz.{name}_reader").READER
    for seed, content in reader.seeds():
        (folder / "seeds" / seed.replace(" ", "-")).write_bytes(content)
    words = (
        word if word.startswith("\\x") else word.replace("\\", "\\\\") for word in reader.words
    )
    lines = ('"' + word.replace('"', '\\"') + '"\n' for word in words)
    (folder / "words").write_text("".join(lines))
    return [*_harness(name, folder), f"-dict={folder / 'words'}"]


def run_target(name: str, command: list[str], folder: Path, seconds: int) -> dict[str, Any]:
    """Fuzz for so long; the row of the result."""
    begin = time.monotonic()
    row: dict[str, Any] = {"target": name, "executions": 0, "edges_start": None, "edges_end": 0,
                           "restarts": -1, "peak_mib": 0, "contained": 0}  # fmt: skip
    while (left := seconds - (time.monotonic() - begin)) > (
        0 if row["restarts"] < 0 else _STARTED_S
    ):
        row["restarts"] += 1
        # Options before the harness's own would be taken for folders.
        options = [f"-max_total_time={int(left) + 1}", f"-timeout={MAX_S}",
                   f"-rss_limit_mb={MAX_MIB}", f"-max_len={MAX_INPUT}",
                   f"-artifact_prefix={folder}/", "-print_final_stats=1"]  # fmt: skip
        result = subprocess.run(
            [*command, *options, str(folder / "corpus"), str(folder / "seeds")],
            capture_output=True, check=False, env=_environment(),
        )  # fmt: skip
        _count(row, result.stderr.decode(errors="replace"))
        for kept in sorted(folder.glob("*-*[0-9a-f]")):
            _judge(name, folder, kept, row)
    found = sorted((folder / "findings").glob("*.txt"))
    return row | {
        "seconds": round(time.monotonic() - begin),
        "findings": [file.read_text().splitlines()[0] for file in found],
    }


def _environment() -> dict[str, str]:
    return os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def _harness(name: str, folder: Path) -> list[str]:
    return [sys.executable, str(_HERE / "harness.py"), name, str(folder)]


def _count(row: dict[str, Any], told: str) -> None:
    edges = [int(count) for _, count in _COVERAGE.findall(told)]
    if edges:
        row["edges_start"] = edges[0] if row["edges_start"] is None else row["edges_start"]
        row["edges_end"] = max(row["edges_end"], edges[-1])
    row["executions"] += sum(map(int, _RUNS.findall(told)))
    row["peak_mib"] = max([row["peak_mib"], *map(int, _RSS.findall(told))])


def _judge(name: str, folder: Path, kept: Path, row: dict[str, Any]) -> None:
    """An input that ended the target, once more as users would give it: is it a finding?"""
    what = "" if name != "wire" else f"{kept.name.partition('-')[0]} in C"
    if name != "wire":
        begin = time.monotonic()
        command = [*_harness(name, folder), "--replay", str(kept)]
        try:
            status = subprocess.run(
                command, check=False, timeout=MAX_S + 5, env=_environment(), capture_output=True,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30)),
            ).returncode  # fmt: skip
        except subprocess.TimeoutExpired:
            status = None
        took_s = time.monotonic() - begin
        if status is None or took_s > MAX_S:
            what = f"takes above {MAX_S} s"
        elif status:
            what = f"ends the process with {status}"
    if what:
        stem = folder / "findings" / kept.name
        stem.with_suffix(".txt").write_text(f"{what}: {kept.name}\n")
        kept.rename(stem.with_suffix(".input"))
    else:
        row["contained"] += 1
        kept.unlink()


def _built(program: Path) -> Path:
    """The C target, with both sanitizers."""
    sources = [_HERE / "fuzz_wire_bytes.c", _PORT / "wire" / "sp_wire.c"]
    links = [_PORT / "posix" / f"sp_link_{kind}.c" for kind in ("serial", "odrive", "bytes")]
    sources += links
    # What the links declare in their own files.
    header = program.parent / "declared_links.h"
    header.write_text(f'#include "sp_link.h"\n{declarations(links)}\n')
    include = [ROOT / "runtime_c" / "include", ROOT / "runtime_c" / "include" / "float",
               ROOT / "runtime_c" / "sim", _PORT / "wire", _PORT / "posix",
               header.parent]  # fmt: skip
    flags = ["-g", "-O1", "-std=c11", "-D_GNU_SOURCE", "-fno-sanitize-recover=all"]
    sanitizers = "-fsanitize=fuzzer,address,undefined"
    subprocess.run(
        ["clang", *flags, sanitizers, *(f"-I{folder}" for folder in include), *map(str, sources),
         "-lm", "-o", str(program)],
        check=True,
    )  # fmt: skip
    return program
