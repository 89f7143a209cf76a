"""Tables as people have them, and calls that a person tries first: taken, or one line says how."""

from datetime import UTC, datetime, timedelta, timezone
from types import SimpleNamespace
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from support.messages import refusing
from support.small import DT_S, press, recording

import springpot
from springpot import Recording
from springpot.codegen.errors import DataError, UsageError
from springpot.host.ensemble import ensemble_data
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.importing import ImportOptions

ITEM = recording("press", np.concatenate([press(hz) for hz in (0.5, 1.6, 5.0)]))
COLUMNS = {
    "time_s": DT_S * np.arange(len(ITEM.force_n)),
    "position_m": ITEM.position_m,
    "force_n": ITEM.force_n,
}


class Table(dict):
    """A table as pandas has it: its items are columns, its repr has lines; the index has a name."""

    def __init__(self, columns, names, index=None):
        super().__init__(columns)
        self.columns, self.index = names, SimpleNamespace(name=index)

    def __repr__(self):
        return "\n".join(self.columns)


@pytest.mark.parametrize(
    "zone", [None, UTC, timezone(timedelta(hours=-5)), ZoneInfo("Europe/Berlin")], ids=str
)
def test_dates_are_read_in_every_time_zone(zone):
    """Half an hour before the clocks go back, and for hours: what is read goes on evenly."""
    begin = datetime(2026, 10, 25, 0, 30, tzinfo=UTC)
    stamps = [begin + timedelta(seconds=10.0 * k) for k in range(len(ITEM.force_n))]
    local = [each.astimezone(zone) if zone else each.replace(tzinfo=None) for each in stamps]
    for given in (local, np.array(local, "O")):
        found = Recording.from_frame({**COLUMNS, "time_s": given})
        assert found.dt_s == pytest.approx(10.0)
        np.testing.assert_array_equal(found.force_n, ITEM.force_n)


def test_missing_units_are_named_once_in_arguments_that_work_and_a_row_by_the_name():
    bare = {name.rpartition("_")[0]: values for name, values in COLUMNS.items()}
    given = 'time="time:s", position="position:mm", force="force:N"'
    with refusing(DataError, "pad: no unit of time, of position, of force", f"as in {given}"):
        Recording.from_frame(bare, "pad", time="time", position="position", force="force")
    assert Recording.from_frame(bare, "pad", **eval(f"dict({given})")).source == "frame"
    holed = COLUMNS | {"force_n": np.where(np.arange(len(ITEM.force_n)) == 5, np.nan, 1.0)}
    with refusing(DataError, "pad, row 5: force is empty"):
        Recording.from_frame(holed, "pad")


@pytest.mark.parametrize("name", COLUMNS)
def test_a_refusal_says_that_a_name_is_there_twice_the_index_or_one_number(name):
    quantity = name.rpartition("_")[0]
    with refusing(UsageError, f"{quantity}='{name}'", "or several, have this name"):
        Recording.from_frame(Table(COLUMNS, [*COLUMNS, name]))
    others = {key: values for key, values in COLUMNS.items() if key != name}
    with refusing(UsageError, f"{quantity}='{name}'", "index", "reset_index()"):
        Recording.from_frame(Table(others, list(others), index=name))
    with refusing(DataError, f"{quantity} ()", "give three 1-D arrays of one length"):
        Recording.from_frame(COLUMNS | {name: 1.0})


@pytest.mark.parametrize("surface_m", [0.5e-3, 2e-3])
def test_a_table_is_conditioned_as_a_file_is(surface_m, tmp_path):
    """The tool starts in the air, the sensor has an offset."""
    away = np.linspace(-surface_m, ITEM.position_m[0], 200)
    position_m = surface_m + np.concatenate([away, ITEM.position_m])
    force_n = 0.25 + np.concatenate([np.zeros(200), ITEM.force_n])
    table = {"time_s": DT_S * np.arange(len(force_n)), "position_m": position_m, "force_n": force_n}
    file = tmp_path / "frame.csv"
    np.savetxt(file, np.column_stack(list(table.values())), "%.17g", ",", header=",".join(table),
               comments="")  # fmt: skip
    asked = Conditioning(contact_force="auto")
    found = Recording.from_frame(table, conditioning=asked)
    options = ImportOptions(conditioning=asked)
    (read,) = springpot.import_recordings(file, options=options)
    np.testing.assert_allclose(found.position_m, read.position_m, atol=1e-12)
    np.testing.assert_allclose(found.force_n, read.force_n, atol=1e-9)
    assert abs(found.details["contact_position_m"] - surface_m) < 3e-4
    assert Recording.from_frame(table).position_m[0] == 0.0
    with refusing(DataError, "position_m spans", "are these mm?"):
        Recording.from_frame(table | {"position_m": 1e3 * position_m})


@pytest.mark.parametrize(("unit", "per_m"), [("mm", 1e3), ("m", 1.0), ("um", 1e6)])
def test_columns_of_a_place_are_its(unit, per_m):
    x_m, y_m = np.random.default_rng(len(unit)).uniform(-0.1, 0.1, 2)
    place = {f"place_x_{unit}": x_m * per_m, f"place_y [{unit}]": y_m * per_m}
    table = COLUMNS | {label: np.full(len(ITEM.force_n), at) for label, at in place.items()}
    assert Recording.from_frame(table).place_m == pytest.approx((x_m, y_m))
    assert Recording.from_frame(COLUMNS).place_m is None
    for label in place:
        with refusing(DataError, "place_x and place_y belong together"):
            Recording.from_frame({name: its for name, its in table.items() if name != label})
        moving = table[label] + np.arange(len(ITEM.force_n)) * 1e-5 * per_m
        with refusing(DataError, "one file a place"):
            Recording.from_frame(table | {label: moving})


PANDAS = Table({name: its[:2] for name, its in COLUMNS.items()}, [*COLUMNS])
NO_RECORDINGS = {
    "a table": (PANDAS, "Recording.from_frame"),
    "a list of tables": ([PANDAS], "Recording.from_frame"),
    "a dict of recordings": ({"a": ITEM}, "list(recordings.values())"),
    "a dict of columns": (dict(PANDAS), "Recording.from_frame"),
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
