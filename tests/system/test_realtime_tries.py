"""Tests against the clock are done again where the machine was held up, and nowhere else."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.paths import ROOT
from support.witness import TRIES, MachineWitness

CONFTEST = """
from support import witness
witness.MachineWitness.longest_s = lambda _self: {held_up_s}
def pytest_configure(config):
    config.addinivalue_line("markers", "realtime: against the clock")
    config.pluginmanager.register(witness.RealtimeTries())
"""
TEST = """
import pathlib, pytest
@pytest.mark.realtime
def test_it(tmp_path):
    tries = pathlib.Path("tries")
    tries.write_text(tries.read_text() + "x" if tries.exists() else "x")
    assert len(tries.read_text()) > {fails}
def test_other():
    pass
"""


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("held_up_s", "fails", "tries", "status"),
    [(0.0, 0, 1, 0), (0.03, 0, 1, 0), (0.0, 1, 1, 1), (0.03, 2, 3, 0), (0.03, 9, TRIES, 1)],
)
def test_tries(tmp_path: Path, held_up_s: float, fails: int, tries: int, status: int) -> None:
    (tmp_path / "conftest.py").write_text(CONFTEST.format(held_up_s=held_up_s))
    (tmp_path / "test_it.py").write_text(TEST.format(fails=fails))
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", "."],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == status, done.stdout + done.stderr
    assert len((tmp_path / "tries").read_text()) == tries
    assert done.stdout.count("TRIED AGAIN") == tries - 1
    assert f"{1 + (not status)} passed" in done.stdout


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="one process a core: Linux")
def test_the_witness_sees_what_it_overslept() -> None:
    witness = MachineWitness()
    try:
        for _ in range(100):  # until it sleeps in its loop
            for sleeper in witness.sleepers:
                sleeper.send_signal(signal.SIGSTOP)
            time.sleep(0.05)
            for sleeper in witness.sleepers:
                sleeper.send_signal(signal.SIGCONT)
            time.sleep(0.02)
            if found_s := witness.longest_s():
                break
        assert found_s >= 0.04
    finally:
        witness.close()
