"""The command line without a process of its own: loading numpy and click once is enough."""

import io
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from unittest import mock

from springpot.host.cli import main


def spring(*arguments: object) -> subprocess.CompletedProcess[str]:
    """What `springpot ARGUMENTS` returns and prints."""
    command = ["springpot", *map(str, arguments)]
    out, err, status = io.StringIO(), io.StringIO(), 0
    with mock.patch.object(sys, "argv", command), redirect_stdout(out), redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            status = int(end.code or 0)
    return subprocess.CompletedProcess(command, status, out.getvalue(), err.getvalue())
