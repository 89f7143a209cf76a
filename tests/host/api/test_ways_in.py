"""Numbers come in as arrays, as a table, as a file or through scikit-learn: checked in one way."""

import warnings

import numpy as np
import pytest
from support.messages import refusing, require_line
from support.small import DT_S, press, recording

import springpot
from springpot import DataError, PositionRegressor, Recording, UsageError

WORDS = ("none", "first", "min")
NO_WORDS = ("max", "Min", "none ", "", 5, 0.0, True, b"min", ("min",), [])
ITEM = recording("press", np.concatenate([press(hz) for hz in (0.5, 1.6, 5.0)]))
TIME_S = DT_S * np.arange(len(ITEM.force_n))


def by_arrays(time_s, position_m, force_n, zero="none", folder=None):
    return Recording("frame", position_m, force_n, float(np.median(np.diff(time_s))), zero)


def by_table(time_s, position_m, force_n, zero="none", folder=None):
    table = {"time_s": time_s, "position_m": position_m, "force_n": force_n}
    return Recording.from_frame(table, zero=zero)


def by_file(time_s, position_m, force_n, zero="none", folder=None):
    rows = np.column_stack([time_s, position_m, force_n])
    file = folder / "frame.csv"
    np.savetxt(file, rows, "%.15g", ",", header="t,x,f", comments="")
    return springpot.import_recordings(file, "time=t:s,position=x:m,force=f:N", zero=zero)[0]


def by_regressor(time_s, position_m, force_n, zero="none", folder=None):
    dt_s = float(np.median(np.diff(time_s)))
    return PositionRegressor("springpot", dt_s, zero=zero).fit([position_m], [force_n])


WAYS = (by_arrays, by_table, by_file, by_regressor)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("way", WAYS)
def test_only_the_words_of_zero_are_taken_on_every_way_in(way, tmp_path):
    for given in NO_WORDS:
        with pytest.raises(UsageError) as refused:
            way(TIME_S, ITEM.position_m, ITEM.force_n, given, tmp_path)
        require_line(refused.value, f"zero={given!r}", *map(repr, WORDS))


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("way", WAYS[:3])
def test_no_zero_is_the_word_for_it(way, tmp_path):
    found = way(TIME_S, ITEM.position_m + 1e-3, ITEM.force_n, None, tmp_path)
    assert found.zero == "none"
    assert found.position_m.min() == pytest.approx(ITEM.position_m.min() + 1e-3)


# What numbers are multiplied by that were taken in another unit: time, position, force.
WRONG = {
    "ms, or counts": (1e3, 1.0, 1.0),
    "us": (1e6, 1.0, 1.0),
    "every second count": (2e3, 1.0, 1.0),
    "min": (1.0 / 60.0, 1.0, 1.0),
    "turns of a screw": (1.0, 50.0, 1.0),
    "um": (1.0, 1e-4, 1.0),
    "uN": (1.0, 1.0, 1e6),
    "kN": (1.0, 1.0, 1e-6),
    "right": (1.0, 1.0, 1.0),
}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_wrong_numbers_have_the_same_findings_on_every_way_in(wrong, tmp_path):
    time_s, position_m, force_n = (
        times * samples
        for times, samples in zip(wrong, (TIME_S, ITEM.position_m, ITEM.force_n), strict=True)
    )
    if wrong[0] >= 1e3:
        time_s = np.round(time_s)
    told = []
    for way in WAYS[:3]:
        checked = springpot.check_recordings(way(time_s, position_m, force_n, folder=tmp_path))
        told.append({(each.kind, each.what) for each in checked.findings})
    assert told[0] == told[1] == told[2]
    assert any(kind == "unit" for kind, _ in told[0]) == (wrong != WRONG["right"])


def test_a_clock_that_began_earlier_hides_no_wrong_unit():
    shifted = by_table(1e3 * TIME_S + 0.25, ITEM.position_m, ITEM.force_n)
    assert "unit" in {each.kind for each in springpot.check_recordings(shifted).findings}
    dates = np.datetime64("2026-01-01") + (1e9 * 1.5 * np.arange(400)).astype("timedelta64[ns]")
    slow_m = 1e-3 * np.sin(np.arange(400) / 40.0) ** 2
    slow = by_table(dates, slow_m, 3e3 * slow_m)
    assert slow.dt_s == pytest.approx(1.5)
    assert "unit" not in {each.kind for each in springpot.check_recordings(slow).findings}


@pytest.mark.parametrize("quantity", ["time", "position", "force"])
@pytest.mark.parametrize("stated", ["x", "1e3x", "-1x", "milli"])
def test_a_unit_contradicts_a_name_in_a_table_where_it_does_in_a_file(quantity, stated, tmp_path):
    """Tell whether a table is refused, and if not, which numbers come of it."""
    units = {"time": ("s", "ms"), "position": ("m", "mm"), "force": ("N", "mN")}
    own, milli = units[quantity]
    unit = milli if stated == "milli" else stated.replace("x", own)
    if quantity == "time" and stated == "-1x":
        unit = "1000ms"
    names = {"time": "t_s", "position": "x [m]", "force": "F_N"}
    values = {"t_s": TIME_S, "x [m]": 1e-3 * ITEM.position_m, "F_N": ITEM.force_n}
    given = {q: f"{name}:{unit}" if q == quantity else name for q, name in names.items()}
    file = tmp_path / "frame.csv"
    rows = np.column_stack(list(values.values()))
    np.savetxt(file, rows, "%.15g", ",", header=",".join(values), comments="")
    found = []
    for call in (
        lambda: Recording.from_frame(values, **given),
        lambda: springpot.import_recordings(file, ",".join(f"{q}={c}" for q, c in given.items())),
    ):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                one = call()
            found.append(one if isinstance(one, Recording) else one[0])
        except DataError as error:
            found.append(str(error))
    table, read = found
    if stated == "milli":
        require_line(table, f"its column's name says {own}", f"{quantity}='{names[quantity]}:0.001")
        assert "--" not in table
        assert "its header says" in read
    elif isinstance(read, Recording):
        assert isinstance(table, Recording), table
        np.testing.assert_allclose(table.position_m, read.position_m, rtol=1e-12)
        np.testing.assert_allclose(table.force_n, read.force_n, rtol=1e-12)
        assert table.dt_s == pytest.approx(read.dt_s)
    else:  # what a sign or a speed refuses after the units are taken
        assert "says" not in read


def table(**more):
    return {"time_s": TIME_S, "position_m": ITEM.position_m, "force_n": ITEM.force_n, **more}


def renamed(names):
    return dict(zip(names, table().values(), strict=True))


MIXED = np.random.default_rng(0).permutation(TIME_S)
JITTER_S = TIME_S + np.random.default_rng(1).uniform(-2e-4, 2e-4, len(TIME_S))
REFUSED_TABLES = {
    "no unit": (renamed(("time_s", "x", "force_n")), {"position": "x"}, "position='x:UNIT'"),
    "mixed rows": (table(time_s=MIXED), {}, "time='RATEHz'"),
    "stamps that stand still": (table(time_s=np.floor(10 * TIME_S) / 10), {}, "time='RATEHz'"),
    "uneven": (table(time_s=JITTER_S), {}, "resample_hz=1000"),
    "too fine": (table(), {"resample_hz": 1e9}, "lower resample_hz"),
    "too coarse": (table(), {"resample_hz": 1e-3}, "higher resample_hz"),
    "time alone": (table(), {"time": None}, "time='None': no such column"),
    "a rate alone": (table(), {"time": "1kHz", "force": "load"}, "force='load': no such column"),
    "a column without name": ({**table(), "": TIME_S}, {"time": "s"}, "time='s': no such column"),
    "an array": (np.zeros((5, 3)), {}, "ndarray is no table"),
    "a path": ("a.csv", {}, "str is no table"),
    "nothing": (None, {}, "NoneType is no table"),
    "two that differ in case": (
        {**table(), "a": TIME_S, "A": TIME_S}, {"time": "a:furlong"}, "unit of time",
    ),
    "truths": (table(force_n=ITEM.force_n > 1.0), {}, "holds bool"),
}  # fmt: skip


@pytest.mark.parametrize(("given", "columns", "says"), REFUSED_TABLES.values(), ids=REFUSED_TABLES)
def test_a_refusal_of_a_table_advises_what_from_frame_takes(given, columns, says):
    with pytest.raises(springpot.SpringpotError) as refused:
        Recording.from_frame(given, **columns)
    require_line(refused.value, says)
    assert " --" not in str(refused.value)


def test_what_a_refusal_of_a_table_advises_is_taken():
    assert Recording.from_frame(table(time_s=JITTER_S), resample_hz=1000).dt_s == 1e-3
    for rate in ("1000Hz", "1 kHz"):
        assert Recording.from_frame(table(time_s=MIXED), time=rate).dt_s == pytest.approx(1e-3)


@pytest.mark.parametrize(
    "names", [("TIME_S", "Position_M", "force_N"), (0, 1, 2), (("t", "s"), ("x", "m"), ("f", "N"))]
)
def test_columns_are_named_by_what_is_shown_of_them(names):
    """Labels of another case, that are no text, or of several levels: as objects, or as text."""
    units = ("s", "m", "N")
    quantities = ("time", "position", "force")
    pairs = zip(quantities, names, units, strict=True)
    stated = [{quantity: f"{name}:{unit}" for quantity, name, unit in pairs}]
    if isinstance(names[0], str):
        stated.append({})
    for columns in stated:
        found = Recording.from_frame(renamed(names), **columns)
        np.testing.assert_array_equal(found.force_n, ITEM.force_n)
    if not isinstance(names[0], str):
        with refusing(DataError, "no unit of time: pass time=", f"{names[0]}:UNIT"):
            Recording.from_frame(renamed(names), **dict(zip(quantities, names, strict=True)))


def test_what_is_edited_later_changes_no_recording():
    position_m, force_n = ITEM.position_m.copy(), ITEM.force_n.copy()
    for given in (lambda x: x, lambda x: x[:], lambda x: x[::1]):
        kept = Recording("a", given(position_m), given(force_n), DT_S)
        before = kept.content_hash
        position_m[50] += 1.0
        force_n[50] = np.nan
        assert kept.content_hash == before
        position_m[50], force_n[50] = ITEM.position_m[50], ITEM.force_n[50]
        for channel in (kept.position_m, kept.force_n):
            with pytest.raises(ValueError, match="read-only"):
                channel[0] = 1.0
    frozen = position_m[:]
    frozen.setflags(write=False)  # a view that another array can write through
    kept = Recording("a", frozen, force_n, DT_S)
    position_m[50] += 1.0
    assert kept.position_m[50] == ITEM.position_m[50]
