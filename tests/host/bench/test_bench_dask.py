"""The sweep on a Dask cluster: a scheduler and two worker processes."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from support.in_process import spring
from support.small import training

from springpot.host.files import write_recordings

_WAIT_S = 60.0


@contextmanager
def process(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    started = subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield started
    finally:
        started.terminate()
        started.wait(timeout=30)


def wait_for(file: Path) -> None:
    end = time.monotonic() + _WAIT_S
    while not file.exists() or not file.read_text():
        assert time.monotonic() < end, f"{file} never came"
        time.sleep(0.1)


@pytest.mark.slow
def test_two_workers_give_the_points_of_one_machine(tmp_path: Path) -> None:
    from distributed import Client  # slow to load, and this test alone needs it

    recordings = str(tmp_path / "training")
    write_recordings(recordings, training())
    known = tmp_path / "scheduler.json"
    with ExitStack() as stack:
        stack.enter_context(
            process("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                    "--scheduler-file", str(known))
        )  # fmt: skip
        wait_for(known)
        address = json.loads(known.read_text())["address"]
        for name in ("one", "two"):
            stack.enter_context(
                process("worker", address, "--name", name, "--nthreads", "1", "--no-dashboard",
                        "--local-directory", str(tmp_path / name))
            )  # fmt: skip
        with Client(address) as cluster:  # a worker that is late would find the work done
            cluster.wait_for_workers(2, timeout=_WAIT_S)
        done = spring("bench", "--recording", recordings, "--model", "hammerstein", "--json",
                      "--out", str(tmp_path / "cluster"), "--dask", address)  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["points"]
    here = spring("bench", "--recording", recordings, "--model", "hammerstein", "--json",
                  "--out", str(tmp_path / "here"))  # fmt: skip
    alike = {(point["hash"], point["number"]): point for point in json.loads(here.stdout)["points"]}
    assert len(found) == 7
    for one in found:
        for name in ("options", "rmse_n", "flash_bytes", "ram_bytes"):
            assert one[name] == alike[one["hash"], one["number"]][name]
