"""Fixtures that several test modules share."""

import os
import signal
import threading
from collections import Counter
from pathlib import Path

import pytest
from support.witness import RealtimeTries

from springpot.codegen.errors import SpringpotError

# The workers of pytest keep every core busy: threads of numerical libraries would wait for each
# other. Before numpy is loaded, and for the processes that tests start.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# A shell that starts the tests in the background has SIGINT ignored, and its children with it.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)


# Tests that another machine had no tools for, one a line: written where the file is not there.
SKIPPED = Path(os.environ.get("SPRINGPOT_SKIPPED") or os.devnull)


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(RealtimeTries())


# Messages name options as commands print them: tests/host/api has what Python says.
SpringpotError.in_command = True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """`few(n, m)`: cases behind the first n are slow, behind m long; what was skipped, slow."""
    again = set(SKIPPED.read_text().split("\n")) if SKIPPED.exists() else set()
    cases: Counter[str] = Counter()
    for item in items:
        test = item.nodeid.partition("[")[0]
        cases[test] += 1
        few = item.get_closest_marker("few")
        if item.nodeid in again or (few and cases[test] > few.args[0]):
            item.add_marker("slow")
        if few and cases[test] > few.args[-1] and len(few.args) > 1:
            item.add_marker("long")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if not SKIPPED.exists():
        skipped = {report.nodeid for report in terminalreporter.stats.get("skipped", [])}
        SKIPPED.write_text("\n".join(sorted(skipped)))


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of recordings made by others, which is no part of the project."""
    named = os.environ.get("SPRINGPOT_DATA", "")
    if not named:
        pytest.skip("SPRINGPOT_DATA names no folder of real recordings")
    folder = Path(named)
    assert folder.is_dir(), f"SPRINGPOT_DATA={named}: no such folder"
    return folder


@pytest.fixture(scope="session")
def mach1_file() -> Path:
    """Real recordings of a Mach-1 tester, in every clone."""
    return Path(__file__).parent / "data" / "mach1" / "Dynamic_data.txt"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Emit the small scene, once for a module."""
    from support.small import model_file, scene  # not before numpy's threads are set

    from springpot.host.emission.emission import emit

    base = tmp_path_factory.mktemp("scene")
    return emit(scene(), model_file(base), base / "c").folder
