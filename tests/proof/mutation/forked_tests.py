"""Run test files in forks of a process that has loaded what they import, springpot apart.

Requests and answers are lines: a JSON list of pytest's arguments, and its exit status or "hung".
"""

import contextlib
import json
import os
import resource
import signal
import sys
import time

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

# Loaded once, for the children to find: after the variables above, which some read then.
import cffi  # noqa: E402, F401
import h5py  # noqa: E402, F401
import hypothesis  # noqa: E402, F401
import numpy.testing  # noqa: E402, F401
import pydantic  # noqa: E402, F401
import pytest  # noqa: E402
import scipy.signal  # noqa: E402, F401
import serial  # noqa: E402, F401
import sklearn.ensemble  # noqa: E402, F401

TIMEOUT_S = 60
MEMORY_BYTES = 4 << 30


def _child(arguments: list[str]) -> None:
    os.setsid()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nothing, descriptor)
    os._exit(int(pytest.main(arguments)))


def main() -> None:
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            try:
                _child(json.loads(line))
            finally:
                os._exit(99)
        until = time.monotonic() + TIMEOUT_S
        status = None
        while status is None and time.monotonic() < until:
            ended, code = os.waitpid(child, os.WNOHANG)
            status = code if ended else None
            time.sleep(0.01)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)  # and what its tests started
        if status is None:
            os.waitpid(child, 0)
        print("hung" if status is None else os.waitstatus_to_exitcode(status), flush=True)


if __name__ == "__main__":
    main()
