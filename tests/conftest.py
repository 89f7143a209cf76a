"""Fixtures that several test modules share."""

import os
import signal
import threading
from pathlib import Path

import pytest
from support.witness import RealtimeTries

# The workers of pytest keep every core busy: threads of numerical libraries would wait for each
# other. Before numpy is loaded, and for the processes that tests start.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# A shell that starts the tests in the background has SIGINT ignored, and its children with it.
if threading.current_thread() is threading.main_thread():
    signal.signal(signal.SIGINT, signal.default_int_handler)

SHARED_DATA = Path(__file__).parents[1].parent / "shared" / "data"


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(RealtimeTries())


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of recordings made by others, which is no part of the project."""
    if not SHARED_DATA.is_dir():
        pytest.skip(f"no real recordings: {SHARED_DATA} is not a folder")
    return SHARED_DATA
