"""The command line without a process of its own: loading numpy and click once is enough.

`python -m support.in_process COMMAND ...` runs several, each one argument, until one fails.
Where a command validates, ticks are paced for a tenth of a second, not for three.
"""

import io
import shlex
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from unittest import mock

from springpot.host.cli import main
from springpot.host.validation.validation import validate


def spring(*arguments: object) -> subprocess.CompletedProcess[str]:
    """What `springpot ARGUMENTS` returns and prints."""
    command = ["springpot", *map(str, arguments)]
    out, err, status = io.StringIO(), io.StringIO(), 0
    with (
        mock.patch.object(sys, "argv", command),
        mock.patch.object(validate, "__defaults__", (0.1,)),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as end:
            status = int(end.code or 0)
    return subprocess.CompletedProcess(command, status, out.getvalue(), err.getvalue())


if __name__ == "__main__":
    for line in sys.argv[1:]:
        done = spring(*shlex.split(line))
        print(done.stdout, end="")
        print(done.stderr, end="", file=sys.stderr)
        if done.returncode:
            sys.exit(done.returncode)
