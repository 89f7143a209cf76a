"""Units of a map beside those of a file: what each of them means, alone."""

import pytest

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.units import choose_unit, factor_to_si


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
