"""Calls that a person tries first: each works, or one line says what to call."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.messages import refusing
from support.small import training

import springpot
from springpot.codegen.errors import UsageError
from springpot.host.ensemble import ensemble_data

ITEM = training()[-1]


class Table(dict):
    """A table as pandas has it: its items are names of columns, its repr has lines."""

    columns = ("time_s", "position_m", "force_n")

    def __repr__(self):
        return "time_s\nposition_m\nforce_n"


TABLE = Table(time_s=[0.0, 1e-3], position_m=[0.0, 1e-3], force_n=[0.0, 1.0])
NO_RECORDINGS = {
    "a table": (TABLE, "Recording.from_frame"),
    "a list of tables": ([TABLE], "Recording.from_frame"),
    "a dict of recordings": ({"a": ITEM}, "list(recordings.values())"),
    "a dict of columns": (dict(TABLE), "Recording.from_frame"),
    "an array": (np.zeros((3, 9)), "Recording(name, position_m, force_n, dt_s)"),
    "a list of arrays": ([np.zeros(9)], "Recording(name, position_m, force_n, dt_s)"),
    "nothing": (None, "read_recordings"),
    "a namespace": (SimpleNamespace(), "read_recordings"),
}
TAKING = {
    "train": springpot.train,
    "check": springpot.check_recordings,
    "ensemble_data": ensemble_data,
    "validate": lambda given: springpot.validate("none", given),
}


@pytest.mark.parametrize("call", TAKING.values(), ids=TAKING)
@pytest.mark.parametrize(("given", "says"), NO_RECORDINGS.values(), ids=NO_RECORDINGS)
def test_what_is_no_list_of_recordings_is_told_how_to_become_one(given, says, call):
    with refusing(UsageError, says):
        call(given)
