"""Model files: what is written is read, whatever else is refused; models of a stiffer object."""

import hashlib
import io
import json
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.c import golden_forces
from support.messages import refusing
from support.paths import ROOT
from support.small import DEPTH_M, VARIANTS, fitted, press, scene, written_model

from springpot.codegen.errors import DataError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import MODEL_SCHEMA, model_bytes, model_hash, read_model
from springpot.codegen.model.regressors import MAX_NESTING, OPERATIONS, Expression
from springpot.codegen.scene import Guard
from springpot.codegen.stages.expressions import _terms_text
from springpot.host.native.scene_library import build_and_load

KIND = "rf-fd"


def read(folder: Path, content: bytes) -> Model:
    path = folder / "x.spm"
    path.write_bytes(content)
    return read_model(path)


def refused(folder: Path, content: bytes) -> str:
    with pytest.raises(DataError) as error:
        read(folder, content)
    line = str(error.value)
    assert line.isprintable() and line.startswith(f"{folder / 'x.spm'}: ")
    return line


def unpacked(content: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Header and arrays of a model file."""
    with np.load(io.BytesIO(content.partition(b"\n")[2])) as stored:
        arrays = {name: stored[name] for name in stored.files}
    return json.loads(arrays.pop("header").tobytes()), arrays


def packed(header: dict[str, Any], arrays: dict[str, np.ndarray], schema: int) -> bytes:
    """A model file with the right checksum, whatever it says."""
    memory = io.BytesIO()
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    np.savez(memory, allow_pickle=False, header=text, **arrays)
    digest = hashlib.sha256(memory.getvalue()).hexdigest().encode()
    return b"springpot-model %d %s\n" % (schema, digest) + memory.getvalue()


@pytest.mark.parametrize("name", golden_forces.models())
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    model = golden_forces.model(name)
    found = read(tmp_path, model_bytes(model))
    assert model_hash(found) == model_hash(model)
    assert (found.provenance, found.trained) == (model.provenance, model.trained)


def test_flips_and_cuts_are_refused(tmp_path: Path) -> None:
    content = model_bytes(golden_forces.model(KIND))
    for place in [*range(120), *np.linspace(120, len(content) - 1, 60).astype(int)]:
        flipped = bytes([content[place] ^ 0x10])
        refused(tmp_path, content[:place] + flipped + content[place + 1 :])
        refused(tmp_path, content[:place])
    refused(tmp_path, content + b"x")


@pytest.mark.parametrize("schema", [4, 7])
def test_another_schema_is_named(schema: int, tmp_path: Path) -> None:
    head = b"model %d " % schema
    content = model_bytes(golden_forces.model(KIND)).replace(b"model 6 ", head, 1)
    assert f"model schema {schema}, this springpot reads 6" in refused(tmp_path, content)


@pytest.mark.parametrize("starts_conditioned", [False, True])
def test_a_file_of_before_the_whole_state(starts_conditioned: bool, tmp_path: Path) -> None:
    """The stored models are such files, from rest; a part of a state is no start."""
    path = ROOT / "tests/golden/forces/hammerstein.spm"
    assert path.read_bytes().startswith(b"springpot-model 5 ")
    header, arrays = unpacked(path.read_bytes())
    header["hammerstein"] |= {"starts_conditioned": starts_conditioned}
    header["hammerstein"]["conditioned"] = {"part": "Memory", "branch_n": {"array": "x"}}
    content = packed(header, arrays, schema=5)
    if starts_conditioned:
        assert "begins with a part of the object's state" in refused(tmp_path, content)
    else:
        assert not read(tmp_path, content).hammerstein.continues


@pytest.mark.parametrize(
    "changes",
    [{"regressor": {"part": "os"}}, {"regressor": {"part": "Forest"}}, {"dt_s": "x"},
     {"regressor": {"array": "none"}}, {"trained": {"part": "TrainedRange", "colour": 1}},
     {"features": [1, 2]}, {"part": "Lags"}, {"dt_s": np.inf}],
)  # fmt: skip
def test_a_header_of_another_program_is_refused(tmp_path: Path, changes: dict[str, object]) -> None:
    header, arrays = unpacked(model_bytes(golden_forces.model(KIND)))
    refused(tmp_path, packed(header | changes, arrays, MODEL_SCHEMA))


@pytest.mark.parametrize(
    ("name", "part", "changes", "reason"),
    [
        ("rf-fd", "features", None, "features, regressor: "),
        ("rf-fd", "trained", {"min_m": 1.0}, "trained.min_m: "),
        ("rf-fd", "features", {"orders": (0.5, 1.001)}, "features.orders: "),
        ("rf-fd", "features", {"taps": np.ones((0, 2))}, "features.taps: shape"),
        ("rf-fd", "regressor", {"weight": 0.0}, "regressor.weight: "),
        ("rf-fd", "regressor", {"bias_n": 1.0, "value_n": np.ones(2)}, "regressor.value_n: "),
        ("rf-fd", "regressor", {"roots": np.zeros(2, np.int32)}, "regressor.left, right: node 0"),
        ("rf-fd", "regressor", {"roots": np.full(1, 10**6, np.int32)}, "regressor.roots: "),
        ("rbf-fd", "regressor", {"weights_n": np.array([np.nan])}, "not finite"),
        ("rbf-fd-fast", "features", {"length": 5}, "features.length: 5 samples"),
        ("rbf-pv", "features", {"weight": 0.0}, "features.weight: "),
        ("rbf-pv", "features", {"length": 0}, "features.length: 0 steps"),
        ("rbf-pv", "features", {"band_m": -1e-6}, "features.band_m: -1e-06 m is negative"),
        *(("rf-history-quantised", "features", {"samples": lags}, "features.samples: (")
          for lags in ((), (1, 2), (0, -3), (0, 0), (0, 3.5), (0, 2**32))),
        ("rbf-fd", "regressor", {"tail_n": np.ones(1)}, "regressor.tail_n: shape"),
        ("hammerstein", "hammerstein", {"bias_n": np.inf}, "hammerstein.bias_n: holds a number"),
        ("hammerstein", "hammerstein", {"span_m": 0.0}, "hammerstein.span_m: "),
        ("hammerstein", "hammerstein", {"tau_s": np.array([-1.0])}, "hammerstein."),
        ("hammerstein", "hammerstein", {"elastic_n": np.full(1, -1.0)}, "hammerstein."),
        ("hammerstein", "hammerstein", {"rate_ratio": 1e5}, "hammerstein.rate_ratio: "),
        ("hammerstein", "hammerstein", {"n_by_depth": -1}, "hammerstein.n_by_depth: "),
    ],
)  # fmt: skip
def test_no_model_is_written_that_c_could_not_render(
    name: str, part: str, changes: dict[str, object] | None, reason: str
) -> None:
    model = golden_forces.model(name)
    value = None if changes is None else replace(getattr(model, part), **changes)
    with refusing(DataError, reason):
        model_bytes(replace(model, **{part: value}))


def test_a_passive_model_with_a_negative_slope_is_not_written() -> None:
    model = golden_forces.model("hammerstein")
    assert model.hammerstein
    for name in ("elastic_n", "branch_n", "stop_n"):
        slopes = getattr(model.hammerstein, name).copy()
        if slopes.size:
            slopes.flat[-1] = -1e-9
            passive = replace(model.hammerstein, **{name: slopes})
            with refusing(DataError, f"{name}: negative"):
                model_bytes(replace(model, hammerstein=passive))


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with refusing(DataError, "none.spm: cannot be read (No such file or directory)"):
        read_model(tmp_path / "none.spm")


POWER_OF_TWO = 8.0  # exact, so that every decision is the same


def forces(model: Model, *motions_m: np.ndarray) -> list[np.ndarray]:
    asked = replace(scene(), guard=Guard(outside="fallback"))
    plan = make_plan(model, asked, accept_unsafe=True)
    library = build_and_load(plan)
    return [library.new_state().run(x, np.zeros_like(x))[0] for x in motions_m]


@pytest.mark.few(1)
@pytest.mark.parametrize("variant", VARIANTS)
def test_the_emitted_force_of_the_stiffened_model_is_the_models_at_factor_x(variant: str) -> None:
    model = fitted(variant, n_centers=20, poles=4)
    motion = np.concatenate([press(2.0, 0.8 * DEPTH_M), press(4.0, 1.1 * DEPTH_M)])
    soft, wrong = forces(model, motion, motion / POWER_OF_TWO)
    (stiff,) = forces(model.stiffened(POWER_OF_TWO), motion / POWER_OF_TWO)
    assert soft.max() > 1.0
    np.testing.assert_allclose(stiff, soft, rtol=1e-5, atol=2e-6 * soft.max())
    assert np.abs(wrong - soft).max() > 0.2 * soft.max()


def test_a_file_that_unpacks_to_more_memory_than_a_model_takes_is_refused(tmp_path: Path) -> None:
    body = io.BytesIO()
    with (
        zipfile.ZipFile(body, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("header.npy", "w") as member,
    ):
        for _ in range(600):
            member.write(bytes(1 << 20))
    digest = hashlib.sha256(body.getvalue()).hexdigest()
    path = tmp_path / "bomb.spm"
    path.write_bytes(f"springpot-model {MODEL_SCHEMA} {digest}\n".encode() + body.getvalue())
    with pytest.raises(DataError, match="unpacks to more than 512 MiB"):
        read_model(path)


def test_an_expression_that_is_none_is_refused(tmp_path: Path) -> None:
    """A file that claims to hold operations: each has its operands, and a force is left."""
    model = written_model()
    right = model.regressor
    assert isinstance(right, Expression)
    assert read(tmp_path, model_bytes(model)).regressor is not None
    for changes, says in (
        ({"operation": right.operation[1:], "operand": right.operand[1:]}, "has no operands"),
        ({"operation": right.operation[::-1].copy()}, "has no operands"),
        ({"operation": right.operation[:7], "operand": right.operand[:7]}, "leaves no force"),
        ({"operation": right.operation + np.int32(20)}, "operation: "),
        ({"operand": right.operand + 2.0}, "operand: "),
        ({"column": right.column + np.int32(9)}, "column: "),
        ({"zero": right.zero[:1]}, "zero: "),
    ):
        with refusing(DataError, says):
            model_bytes(replace(model, regressor=replace(right, **changes)))


@pytest.mark.parametrize(("levels", "is_taken"), [(MAX_NESTING, True), (MAX_NESTING + 1, False)])
def test_an_expression_is_nested_no_deeper_than_it_can_be_written(
    tmp_path: Path, levels: int, is_taken: bool
) -> None:
    """A small file once ended `emit` by Python's limit of recursion."""
    model, names = written_model(), list(OPERATIONS)
    assert isinstance(model.regressor, Expression)
    written = ["FeatureRef"] + ["AbsExpr"] * (levels - 1)
    operation = np.array([names.index(name) for name in written], np.int32)
    deep = replace(model.regressor, operation=operation, operand=np.zeros(levels))
    if is_taken:
        kept = read(tmp_path, model_bytes(replace(model, regressor=deep))).regressor
        assert isinstance(kept, Expression)
        assert _terms_text(kept.operation.tobytes(), kept.operand.tobytes())
        return
    with refusing(DataError, "nested deeper than"):
        model_bytes(replace(model, regressor=deep))
