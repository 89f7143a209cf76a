"""Calls that a person tries first: each works, or one line says what to call."""

import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from support.messages import refusing
from support.small import passive_model, scene, training

import springpot
from springpot import Recording
from springpot.codegen.errors import DataError, UsageError
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


def test_a_recording_is_taken_for_its_positions(tmp_path):
    force_n = springpot.predict(passive_model(), ITEM)
    np.testing.assert_array_equal(force_n, springpot.predict(passive_model(), ITEM.position_m))
    springpot.emit(tmp_path / "c", model=passive_model(), scene=scene())
    loaded = springpot.load(tmp_path / "c")
    for of_recording, of_positions in zip(
        loaded.run(ITEM), loaded.run(ITEM.position_m), strict=True
    ):
        np.testing.assert_array_equal(of_recording, of_positions)
    slower = Recording("slow", ITEM.position_m, ITEM.force_n, 2e-3)
    for call in (loaded.run, lambda one: springpot.predict(passive_model(), one)):
        with pytest.raises(springpot.SpringpotError, match="slow is sampled at 500 Hz"):
            call(slower)


@pytest.mark.parametrize(
    "position_m",
    [[ITEM.position_m, ITEM.position_m], ITEM.position_m[:, None], [[0.0], [0.0, 1e-3]], "a", None],
    ids=["a list", "a column", "uneven", "text", "nothing"],
)
def test_predict_asks_for_one_press_at_a_time(position_m):
    with refusing(DataError, "position_m: ", "give "):
        springpot.predict(passive_model(), position_m)


@pytest.mark.parametrize("wrong", [None, 3, [ITEM]])
def test_what_is_no_file_is_not_read(wrong):
    with pytest.raises(UsageError, match=r"read_recordings\(\*paths\)"):
        springpot.read_recordings(wrong)
    with pytest.raises(UsageError, match="or a list of files"):
        springpot.import_recordings(wrong)


TURNED = {"force": (1.0, -1.0), "position": (-1.0, 1.0)}


@pytest.mark.parametrize("signs", TURNED.values(), ids=TURNED)
def test_a_turned_sign_is_said_where_a_recording_meets_a_model(signs, tmp_path, caplog):
    turned = Recording("neg", signs[0] * ITEM.position_m, signs[1] * ITEM.force_n, ITEM.dt_s)
    for item, doubted in ((ITEM, False), (turned, True)):
        folder = tmp_path / item.name
        folder.mkdir()
        springpot.emit(folder / "c", model=passive_model(), scene=scene())
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            springpot.predict(passive_model(), item)
        told = "; ".join(str(one.message) for one in said)
        assert ("turn " in told and f"{item.name}: force falls" in told) == doubted
        caplog.clear()
        springpot.validate(folder / "c", item, paced_s=0.01)
        assert ("force falls as position rises" in caplog.text) == doubted
