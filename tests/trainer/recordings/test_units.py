"""Units and column maps of files from outside."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from support.messages import refusing

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.column_map import Column, parse_map
from springpot.trainer.recordings.formats.importing import import_file, parse_place
from springpot.trainer.recordings.formats.units import Quantity, choose_unit, factor_to_si


@pytest.mark.parametrize(
    ("unit", "quantity", "factor"),
    [("s", "time", 1.0), ("ms", "time", 1e-3), ("us", "time", 1e-6), ("µs", "time", 1e-6),
     ("μs", "time", 1e-6), ("min", "time", 60.0), ("mm", "position", 1e-3),
     ("µm", "position", 1e-6), ("in", "position", 0.0254), ("33mm", "position", 33e-3),
     ("-1 mm", "position", -1e-3), ("1e-3m", "position", 1e-3), ("N", "force", 1.0),
     ("mN", "force", 1e-3), ("18N", "force", 18.0), ("gf", "force", 9.80665e-3),
     ("kgf", "force", 9.80665), ("lbf", "force", 4.4482216152605), ("kg", "force", 9.80665),
     ("n", "force", 1.0), ("KN", "force", 1e3), ("Millimetre", "position", 1e-3),
     ("cm", "position", 1e-2), ("um", "position", 1e-6), ("nm", "position", 1e-9),
     ("uN", "force", 1e-6), ("ns", "time", 1e-9), ("h", "time", 3600.0),
     ("ozf", "force", 0.27801385095378125), ("lb", "force", 4.4482216152605),
     ("-1 MM", "position", -1e-3)],  # both signs that stand for micro: its own, and the Greek mu
)  # fmt: skip
def test_factor(unit: str, quantity: Quantity, factor: float) -> None:
    assert factor_to_si(unit, quantity, "x.csv") == pytest.approx(factor, rel=1e-14)


@pytest.mark.parametrize(
    ("unit", "quantity", "message"),
    [("", "force", "no unit of force"), ("18", "force", "no unit of force"),
     ("furlong", "position", "'furlong' is not a unit of position"),
     ("MN", "force", "'MN' is not a unit of force"), ("mn", "force", "'mn' is not a unit of force"),
     ("kPa", "force", "the specimen's height and area before"),
     ("%", "position", "the specimen's height and area before"),
     ("mm", "force", "'mm' is not a unit of force"), ("0mm", "position", "a factor of 0")],
)  # fmt: skip
def test_refused_units(unit: str, quantity: Quantity, message: str) -> None:
    with refusing(DataError, "x.csv, column 2: ", message):
        factor_to_si(unit, quantity, "x.csv, column 2")


def test_a_place_has_one_unit_or_two() -> None:
    for text in ("5,10mm", "5mm,1cm", "0.5cm,10mm"):
        assert parse_place(text) == pytest.approx((0.005, 0.01))
    with pytest.raises(UsageError, match="no unit of position"):
        parse_place("5mm,10")


def test_map() -> None:
    assert parse_map("time=Time, s:s, position=Engineering Strain:33mm,force=3:18N") == {
        "time": Column("Time, s", "s"),
        "position": Column("Engineering Strain", "33mm"),
        "force": Column(3, "18N"),
    }
    for text, rate_hz in (("10Hz", 10.0), ("1 kHz", 1000.0), ("2.5e3Hz", 2500.0)):
        assert parse_map(f"time={text}")["time"].rate_hz == rate_hz
    assert parse_map("force=Engineering Stress (MPa)") == {
        "force": Column("Engineering Stress (MPa)")
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "cannot read ''"), ("speed=1:m", "cannot read 'speed=1:m'"),
     ("time=1:s,time=2:s", "given twice"), ("time=:s", "time has no column"),
     ("time=0:s", "counted from 1")],
)  # fmt: skip
def test_refused_maps(text: str, message: str) -> None:
    with refusing(UsageError, "--map", message):
        parse_map(text)
    with refusing(UsageError, "time=0Hz", "is no rate", "time=1000Hz"):
        parse_map("time=0Hz")


@pytest.mark.parametrize(
    ("units", "height_mm", "area_mm2"),
    [(("%", "kPa"), 12.5, 660.0), (("mm/mm", "MPa"), 33.0, 18.0), (("%", "psi"), 80.0, 9e3)],
)
def test_the_printed_factors_of_a_specimen_lead_to_its_force(
    units: tuple[str, str], height_mm: float, area_mm2: float, tmp_path: Path
) -> None:
    depth_m, force_n = np.linspace(0.0, 4e-3, 200), np.linspace(0.0, 3.3, 200)
    strain = depth_m / (height_mm * 1e-3) / {"%": 0.01, "mm/mm": 1.0}[units[0]]
    stress = force_n / (area_mm2 * 1e-6) / {"kPa": 1e3, "MPa": 1e6, "psi": 6894.757}[units[1]]
    header = f"Time [s],Strain [{units[0]}],Stress [{units[1]}]"
    rows = np.column_stack([np.arange(200) / 100.0, strain, stress])
    np.savetxt(tmp_path / "a.csv", rows, "%.9g", ",", header=header, comments="")
    with pytest.raises(DataError) as refused:
        import_file(tmp_path / "a.csv")
    found = re.findall(r"(height|area) in mm2?(?: times (\S+))? \(", str(refused.value))
    factors = {size: float(times or 1.0) for size, times in found}
    (option,) = shlex.split(re.findall(r"--map ('.*?'),", str(refused.value))[0])
    right = option.replace("FACTORmm", f"{factors['height'] * height_mm:.9g}mm")
    right = right.replace("FACTORN", f"{factors['area'] * area_mm2:.9g}N")
    read, _ = import_file(tmp_path / "a.csv", parse_map(right))
    assert read.position_m.max() == pytest.approx(4e-3)
    assert read.force_n.max() == pytest.approx(3.3)
    if units[0] == "%":
        with pytest.raises(DataError, match="m high"):
            import_file(tmp_path / "a.csv", parse_map("position=Strain [%]:33mm,force=3:18N"))


@pytest.mark.parametrize("text", ["0mm", "0.0mm", "-0mm"])
def test_a_factor_of_zero_leaves_nothing(text: str) -> None:
    with pytest.raises(DataError, match="a factor of 0"):
        factor_to_si(text, "position", "a.csv")


@pytest.mark.parametrize(
    ("stated", "to_si"), [("18N", 18.0), ("1N", 1.0), ("N", None), ("-1N", None)]
)
def test_a_unit_of_stress_wants_an_area_or_a_1(stated: str, to_si: float | None) -> None:
    """ "1N": it is in newtons after all, as a person says."""
    found = {"map": stated, "header": "kPa"}
    if to_si is None:
        with pytest.raises(DataError, match="a unit of stress or strain"):
            choose_unit(found, "force", "a.csv", "F")
    else:
        assert choose_unit(found, "force", "a.csv", "F").to_si == to_si
