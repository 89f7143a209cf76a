"""What a model's parts must be, each rule at its border: the last value taken, the first not."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from support.messages import refusing
from support.small import damage, flow

from springpot import Model
from springpot.codegen.errors import DataError
from springpot.codegen.model.features import (
    FastFirBank,
    FirBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.field_types import MAX_NUMBER, require_types
from springpot.codegen.model.model import TrainedRange
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.regressors import Forest, Quantisation, Rbf
from springpot.codegen.model.validity import require_valid

ones = np.ones
PASSIVE = Hammerstein(
    origin_m=0.0, span_m=0.01, elastic_n=ones(3), tau_s=ones(2),
    branch_n=ones((2, 3)), radius_m=ones(1), stop_n=ones((1, 3)), bias_n=0.0,
)  # fmt: skip
FLOW, DAMAGE = flow(1.0), damage(ones(3))
RANGE = TrainedRange(min_m=0.0, max_m=0.01, max_mps=0.1, min_n=0.0, max_n=3.0)
FIR = FirBank((0.25, 0.5), ones((4, 2)))
FAST = FastFirBank((0.25, 0.5), ones(3), length=10, weights=ones((6, 2)))  # two direct taps
RECURSIVE = RecursiveBank((0.25, 0.5), ones(3), ones((3, 2)))
LEAF = Forest(
    feature=np.full(1, -1, np.int32), threshold=np.zeros(1), left=np.zeros(1, np.int32),
    right=np.zeros(1, np.int32), value_n=ones(1), roots=np.zeros(1, np.int32), weight=1.0,
    bias_n=0.0,
)  # fmt: skip
BINS = Quantisation(np.zeros(2), ones(2))
RBF = Rbf(ones(2), ones(2), -ones(2), ones(2), ones((3, 2)), ones(3), ones(3))
MODEL = Model("rf-fd", "x", 1e-3, "surface", RANGE, FIR, LEAF, PASSIVE, False)
TERMS = 1000
SAMPLES = 1_000_000


def bank(part: Any, orders: tuple[float, ...]) -> Any:
    """The bank with a column for each order."""
    table = np.ones((len(getattr(part, part.table)), len(orders)))
    return dataclasses.replace(part, orders=orders, **{part.table: table})


def terms(branches: int, stops: int) -> dict[str, Any]:
    return {
        "tau_s": ones(branches), "branch_n": ones((branches, 3)),
        "radius_m": ones(stops), "stop_n": ones((stops, 3)),
    }  # fmt: skip


# part, field: the last values that it takes, the first that it does not
NUMBERS: list[tuple[Any, str, list[Any], list[Any]]] = [
    (MODEL, "dt_s", [1e-6, 1e2], [0.999e-6, 100.1]),
    (MODEL, "kind", ["A", "9_.+-" + "z" * 59], ["", "-a", "a/b", "z" * 65]),
    (RANGE, "min_m", [-100.0, 0.01], [-100.1, math.nan]),
    (RANGE, "max_m", [100.0], [100.1]),
    (RANGE, "min_n", [-1e4], [-1.001e4]),
    (RANGE, "max_n", [1e4], [1.001e4]),
    (RANGE, "max_mps", [0.0, 1e4], [-1e-9, 1.001e4]),
    (PASSIVE, "span_m", [1e-9, 100.0], [0.0, 100.1]),
    (PASSIVE, "origin_m", [-100.0, 100.0], [-100.1, 100.1]),
    (PASSIVE, "n_by_depth", [2], [-1, 3]),
    (PASSIVE, "rate_ratio", [1e-4, 1e4], [0.999e-4, 1.001e4]),
    (PASSIVE, "tau_s", [], [np.array([1.0, 0.0])]),
    (PASSIVE, "radius_m", [], [np.zeros(1)]),
    *[(PASSIVE, name, [np.zeros_like(getattr(PASSIVE, name))],
       [-1e-9 * np.ones_like(getattr(PASSIVE, name))])
      for name in ("elastic_n", "branch_n", "stop_n")],
    (FIR, "taps", [ones((1, 2)), ones((SAMPLES, 2))], [ones((0, 2)), ones((SAMPLES + 1, 2))]),
    (FAST, "length", [4, SAMPLES], [3, SAMPLES + 1]),
    (FAST, "tau_ticks", [], [np.zeros(3), ones(0), ones(TERMS + 1)]),
    (RECURSIVE, "tau_s", [], [np.array([1.0, -1.0, 1.0]), ones(TERMS + 1)]),
    (Lags((0,), False), "samples", [(0,), (0, 1, SAMPLES)],
     [(0, 2, 2), (1, 2), (0, SAMPLES + 1), ()]),
    (PositionVelocity(1, 0.0), "length", [1, SAMPLES], [0, SAMPLES + 1]),
    (PositionVelocity(1, 0.0), "band_m", [0.0, 100.0], [-1e-9, 100.1]),
    (LEAF, "weight", [1e-9], [0.0]),
    (LEAF, "roots", [], [np.zeros(0, np.int32)]),
    (BINS, "bins_per_unit", [np.array([1e-9, 1.0])], [np.zeros(2)]),
    (RBF, "scale", [], [np.array([1.0, 0.0])]),
    (RBF, "feature_min", [ones(2)], [np.array([0.0, 1.1])]),
]  # fmt: skip
# part, arrays of another shape than its others ask for
SHAPES: list[tuple[Any, dict[str, Any]]] = [
    (PASSIVE, {"elastic_n": ones((3, 1)), "tau_s": ones((2, 1)), "branch_n": ones((1, 3)),
               "radius_m": ones((1, 1)), "stop_n": ones((2, 3))}),
    (FIR, {"taps": ones((4, 3))}),
    (FAST, {"tau_ticks": ones((3, 1)), "weights": ones((6, 3))}),
    (RECURSIVE, {"weights": ones((2, 2))}),
    (BINS, {"bins_per_unit": ones(3)}),
    (RBF, {**dict.fromkeys(("mean", "scale", "feature_min", "feature_max"), ones(1)),
           "centers": ones((3, 1)), "weights_n": ones(2), "tail_n": ones(2)}),
]  # fmt: skip
# Of several fields; what the refusal begins with.
TAKEN: list[tuple[Any, dict[str, Any]]] = [
    (MODEL, {"hammerstein_adds": True}),
    (MODEL, {"hammerstein": None}),
    (MODEL, {"features": None, "regressor": None, "hammerstein_adds": True}),
    (PASSIVE, terms(TERMS, TERMS)),
    (PASSIVE, terms(0, 0)),
    (PASSIVE, {"flow": FLOW, "damage": DAMAGE, "recovers": True}),
    (bank(FIR, (0.0, 1.0)), {}),
    (bank(FIR, (0.5,)), {}),
    (bank(FIR, (0.5,) * TERMS), {}),
    (FAST, {"weights": ones((5, 2)), "length": 3}),  # one direct tap
    (FAST, {"tau_ticks": ones(TERMS), "weights": ones((TERMS + 2, 2))}),
    (RECURSIVE, {"tau_s": ones(TERMS), "weights": ones((TERMS, 2))}),
    (RECURSIVE, {"tau_s": ones(1), "weights": ones((1, 2))}),
    (LEAF, {"quantisation": BINS}),
    (RBF, {"centers": ones((1, 2)), "weights_n": ones(1)}),
]
REFUSED: list[tuple[Any, dict[str, Any], str]] = [
    (MODEL, {"features": None}, "features, regressor: "),
    (MODEL, {"regressor": None}, "features, regressor: "),
    (MODEL, {"features": None, "regressor": None}, "regressor, hammerstein: "),
    (MODEL, {"hammerstein": None, "hammerstein_adds": True}, "hammerstein_adds: "),
    (MODEL, {"provenance": {"seed": -1}}, "provenance"),
    (MODEL, {"trained": dataclasses.replace(RANGE, min_m=1.0)}, "trained.min_m, max_m: "),
    (MODEL, {"features": dataclasses.replace(FIR, taps=ones((0, 2)))}, "features.taps: "),
    (MODEL, {"regressor": dataclasses.replace(LEAF, weight=0.0)}, "regressor.weight: "),
    (MODEL, {"hammerstein": dataclasses.replace(PASSIVE, span_m=0.0)}, "hammerstein.span_m: "),
    (PASSIVE, {"elastic_n": ones(8)}, "branch_n: shape (2, 3), not (2, 8)"),
    (PASSIVE, {"elastic_n": ones(0)}, "elastic_n: 0 nodes"),
    (PASSIVE, {"flow": dataclasses.replace(FLOW, force_n=-FLOW.force_n)}, "flow.force_n: -"),
    (PASSIVE, {"damage": dataclasses.replace(DAMAGE, curve_n=ones((4, 8)))}, "damage.curve_n: "),
    (FLOW, {"power": np.array([3, 2])}, "power: not all of (3, 5)"),
    (FLOW, {"degree": np.array([1, 3])}, "degree: not all of (1, 2, 4)"),
    (FLOW, {"rate_ps": np.array([1.0, 0.0])}, "rate_ps: 0 is not above 0"),
    (FLOW, {"force_n": ones(3)}, "force_n: shape (3,), not (2,)"),
    (PASSIVE, terms(TERMS + 1, 0), "tau_s, radius_m: "),
    (PASSIVE, terms(0, TERMS + 1), "tau_s, radius_m: "),
    *[(bank(part, ()), {}, "orders: ()") for part in (FIR, FAST, RECURSIVE)],
    (bank(FIR, (0.5,) * (TERMS + 1)), {}, "orders: (0.5, 0.5, "),
    (bank(FIR, (0.5, 1.001)), {}, "orders: (0.5, 1.001)"),
    (bank(FIR, (-0.001, 0.5)), {}, "orders: (-0.001, 0.5)"),
    (FAST, {"tau_ticks": ones(5)}, "weights: 6 rows for 5 poles"),
    (LEAF, {"quantisation": Quantisation(np.zeros(1), ones(2))}, "quantisation.feature_min: shape"),
    (RBF, {"centers": ones((0, 2)), "weights_n": ones(0)}, "centers: "),
]  # fmt: skip


def require_refused(part: Any, changes: dict[str, Any], *told: str) -> None:
    with refusing(DataError, *told):
        require_valid(dataclasses.replace(part, **changes), 2)


@pytest.mark.parametrize(("part", "field", "taken", "beyond"), NUMBERS)
def test_a_field_at_its_border_is_taken_and_beyond_it_refused(
    part: Any, field: str, taken: list[Any], beyond: list[Any]
) -> None:
    for value in taken:
        require_valid(dataclasses.replace(part, **{field: value}), 2)
    for value in beyond:
        require_refused(part, {field: value}, field, ": ")


@pytest.mark.parametrize(("part", "arrays"), SHAPES)
def test_an_array_of_another_shape_is_refused(part: Any, arrays: dict[str, Any]) -> None:
    for field, array in arrays.items():
        require_refused(part, {field: array}, f"{field}: shape {array.shape}, not (")


@pytest.mark.parametrize(("part", "changes"), TAKEN)
def test_parts_that_fit_together_are_taken(part: Any, changes: dict[str, Any]) -> None:
    require_valid(dataclasses.replace(part, **changes), 2)


@pytest.mark.parametrize(("part", "changes", "told"), REFUSED)
def test_parts_that_do_not_are_refused(part: Any, changes: dict[str, Any], told: str) -> None:
    require_refused(part, changes, told)


@dataclass(frozen=True)
class Inner:
    number: float


@dataclass(frozen=True)
class Outer:
    word: Literal["one", "two"]
    text: str
    whole: int
    number: float
    yes: bool
    items: tuple[int, ...]
    reals: NDArray[np.float64]
    rows: NDArray[np.int32]
    inner: Inner | None
    more: int = 0
    made: tuple[int, ...] = dataclasses.field(default_factory=tuple)


FITS: dict[str, list[Any]] = {
    "word": ["one", "two"],
    "text": ["x", "é" * 200],
    "whole": [0, -(10**30), 10**30],
    "number": [0.0, 1, -MAX_NUMBER, MAX_NUMBER],
    "yes": [True, False],
    "items": [(), (1, 2), (0,) * 10_000],
    "reals": [np.zeros(0), np.array([-MAX_NUMBER, MAX_NUMBER]), np.zeros((2, 2))],
    "rows": [np.zeros(2, np.int32)],
    "inner": [None, Inner(1.0)],
    "more": [5],
    "made": [(3,)],
}
LONG = "x" * 58  # its repr is as long as is shown
DOES_NOT: list[tuple[str, Any, str]] = [
    ("word", "three", "'three' is none of one, two"),
    ("word", 1, "1 is none of one, two"),
    ("word", ["one"], "list is none of one, two"),
    ("text", "", "'' is no printable text"),
    ("text", "é" * 201, f"'{'é' * 56}... is no printable text"),
    ("text", "a\n", r"'a\n' is no printable text"),
    ("text", 1, "1 is no printable text"),
    ("word", LONG, f"'{LONG}' is none of one, two"),
    ("word", LONG + "x", f"'{LONG[:56]}... is none of one, two"),
    ("whole", 1.0, "1.0 is no whole number"),
    ("whole", True, "True is no whole number"),
    ("whole", 2 * 10**30, f"{2 * 10**30} is no whole number"),
    ("whole", None, "None is no whole number"),
    ("number", True, "True is no finite number"),
    ("number", 1.1 * MAX_NUMBER, f"{1.1 * MAX_NUMBER} is no finite number"),
    ("number", -1.1 * MAX_NUMBER, f"{-1.1 * MAX_NUMBER} is no finite number"),
    ("number", math.nan, "nan is no finite number"),
    ("number", "1", "'1' is no finite number"),
    ("yes", 1, "1 is no bool"),
    ("items", [1], "list is no list of at most 10000"),
    ("items", (0,) * 10_001, "tuple is no list of at most 10000"),
    ("items", (1, 2.5), "2.5 is no whole number"),
    ("reals", [1.0], "list is no array"),
    ("reals", np.zeros(2, np.float32), "an array of float32, not of float64"),
    ("rows", np.zeros(2, np.int64), "an array of int64, not of int32"),
    ("reals", np.array([0.0, math.nan]), "a number that is not finite, or above 1e+30"),
    ("reals", np.array([0.0, 1.1 * MAX_NUMBER]), "a number that is not finite, or above 1e+30"),
    ("reals", np.array([0.0, -1.1 * MAX_NUMBER]), "a number that is not finite, or above 1e+30"),
    ("inner", Outer, "type is no Inner"),
    ("inner", 1, "1 is no Inner"),
]


def test_fields_of_their_types_are_taken() -> None:
    plain = {name: values[0] for name, values in FITS.items()}
    require_types(Outer, {n: v for n, v in plain.items() if n not in ("more", "made")}, "outer")
    for name, values in FITS.items():
        for value in values:
            require_types(Outer, {**plain, name: value}, "outer")


@pytest.mark.parametrize(("name", "value", "told"), DOES_NOT)
def test_a_field_of_another_type_is_told(name: str, value: Any, told: str) -> None:
    plain = {field: values[0] for field, values in FITS.items()}
    with refusing(DataError, f"outer.{name}: {told}"):
        require_types(Outer, {**plain, name: value}, "outer")


def test_fields_that_are_missing_or_unknown_are_told() -> None:
    plain = {field: values[0] for field, values in FITS.items()}
    with pytest.raises(DataError, match=r"^outer: unknown Outer field 'a'$"):
        require_types(Outer, {**plain, "b": 1, "a": 1}, "outer")
    del plain["word"], plain["text"]
    with pytest.raises(DataError, match=r"^outer\.text: missing$"):
        require_types(Outer, plain, "outer")
