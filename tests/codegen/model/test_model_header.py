"""The first line and the header of a model file: each thing that can be wrong, and its words."""

import dataclasses
import hashlib
import io
import json
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from support.c import golden_forces
from support.files.hostile_models import closed, opened
from support.messages import refusing

from springpot.codegen.errors import DataError
from springpot.codegen.model import model_file
from springpot.codegen.model.model_file import (
    MODEL_MAGIC,
    MODEL_SCHEMA,
    MODEL_SUFFIX,
    model_bytes,
    model_hash,
    read_model,
    register_part,
    write_model,
)

KIND = "rf-fd"


def refused(folder: Path, content: bytes) -> str:
    path = folder / "x.spm"
    path.write_bytes(content)
    with pytest.raises(DataError) as error:
        read_model(path)
    told = str(error.value)
    assert told.isprintable()
    assert told.startswith(f"{path}: ")
    return told.removeprefix(f"{path}: ").removesuffix(
        ": springpot never writes such a model, train again"
    )


def changed(folder: Path, **changes: Any) -> str:
    """The refusal of a file whose header has these values; names with `__` are inside parts."""
    header, arrays = opened(KIND)
    for name, value in changes.items():
        *outer, last = name.split("__")
        part = header
        for key in outer:
            part = part[key]
        part[last] = value
    return refused(folder, closed(header, arrays))


def test_the_first_line_is_magic_schema_and_checksum(tmp_path: Path) -> None:
    content = model_bytes(golden_forces.model(KIND))
    line, _, body = content.partition(b"\n")
    assert line == b"springpot-model 5 " + hashlib.sha256(body).hexdigest().encode()
    assert MODEL_MAGIC == b"springpot-model"
    assert MODEL_SCHEMA == 5
    assert MODEL_SUFFIX == ".spm"
    digest = line.split()[2]
    beginnings = (b"springpot-modes 5 ", b"springpot-model x ", b"springpot-model -4 ")
    for wrong in (b"springpot-model 5", line + b" x", b"", *(b + digest for b in beginnings)):
        told = refused(tmp_path, wrong + b"\n" + body)
        assert told == "not a springpot model: `springpot train --out FILE.spm` makes one"
    told = refused(tmp_path, b"springpot-model 6 " + digest + b"\n" + body)
    assert told.startswith("model schema 6, this springpot reads 5: upgrade springpot")
    told = refused(tmp_path, line + b"\n" + body + b"x")
    assert told == "damaged (checksum differs): copy it again or train again"


def test_the_file_is_what_is_written_and_its_hash_is_of_what_is_in_it(tmp_path: Path) -> None:
    model = golden_forces.model(KIND)
    path = tmp_path / "a.spm"
    assert write_model(path, model) == model_hash(model)
    assert path.read_bytes() == model_bytes(model)
    body = path.read_bytes().partition(b"\n")[2]
    with np.load(io.BytesIO(body)) as stored:
        arrays = {name: stored[name] for name in stored.files}
    text = arrays.pop("header").tobytes()
    assert text == json.dumps(json.loads(text), sort_keys=True).encode()
    digest = hashlib.sha256(text)
    for name in sorted(arrays):
        values = arrays[name]
        digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode() + values.tobytes())
    assert model_hash(model) == digest.hexdigest()
    assert len(arrays) >= 8
    header = json.loads(text)
    assert header["part"] == "Model"
    assert header["provenance"] == dict(model.provenance)
    assert isinstance(header["features"]["orders"]["tuple"], list)
    assert header["regressor"]["left"] == {"array": "model.regressor.left"}


def test_an_array_that_is_not_contiguous_has_the_same_hash() -> None:
    model = golden_forces.model(KIND)
    features = dataclasses.replace(model.features, taps=np.asfortranarray(model.features.taps))
    assert model_hash(dataclasses.replace(model, features=features)) == model_hash(model)


@pytest.mark.parametrize("length", [0, 5, 40, 90, 5000, -1])
def test_a_truncated_file_is_refused(tmp_path: Path, length: int) -> None:
    told = refused(tmp_path, model_bytes(golden_forces.model(KIND))[:length])
    assert told.startswith(("damaged", "not a springpot model"))


def test_any_flipped_byte_is_refused(tmp_path: Path) -> None:
    content = model_bytes(golden_forces.model(KIND))
    for place in [*range(120), *np.linspace(120, len(content) - 1, 50).astype(int)]:
        flipped = bytes([content[place] ^ 0x10])
        refused(tmp_path, content[:place] + flipped + content[place + 1 :])


@pytest.mark.parametrize("digits", [1, 9, 10, 4300, 5000, 100_000])
@pytest.mark.parametrize("digit", ["0", "9"])
def test_a_schema_of_any_length_is_refused_in_a_line(
    tmp_path: Path, digits: int, digit: str
) -> None:
    _, _, body = model_bytes(golden_forces.model(KIND)).partition(b"\n")
    checksum = hashlib.sha256(body).hexdigest()
    told = refused(tmp_path, f"springpot-model {digit * digits} {checksum}\n".encode() + body)
    assert "not a springpot model" in told or told.startswith("model schema ")
    assert len(told) < 200


@pytest.mark.parametrize("name", golden_forces.models())
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    model = golden_forces.model(name)
    path = tmp_path / "x.spm"
    path.write_bytes(model_bytes(model))
    found = read_model(path)
    assert model_hash(found) == model_hash(model)
    assert found.provenance == model.provenance
    assert found.trained == model.trained


def test_a_header_that_is_none_is_told(tmp_path: Path) -> None:
    header, arrays = opened(KIND)
    assert refused(tmp_path, closed("{", arrays)).startswith("header: no JSON (")
    assert refused(tmp_path, closed("[" * 100_000, arrays)).startswith("header: no JSON (")
    for value in ({}, {"array": "model.features.taps"}, {"array": "x"}, [], 3, {"tuple": [1]}):
        told = refused(tmp_path, closed(value, arrays))
        assert told in ("model: names no array of this file", "header: describes no model")
    assert refused(tmp_path, closed(header["trained"], {})) == "header: describes no model"
    for word in ("NaN", "Infinity", "-Infinity"):
        text = json.dumps(header).replace('"dt_s": 0.001', f'"dt_s": {word}')
        assert refused(tmp_path, closed(text, arrays)) == f"header: {word} is no number of JSON"
    memory = io.BytesIO()
    np.savez(memory, **arrays)
    body = memory.getvalue()
    line = b"springpot-model 5 " + hashlib.sha256(body).hexdigest().encode() + b"\n"
    assert refused(tmp_path, line + body).startswith("header: no JSON (")


def test_only_known_parts_are_made(tmp_path: Path) -> None:
    told = changed(tmp_path, regressor__part="os" * 50)
    assert told.startswith(f"model.regressor: no known part {('os' * 50)[:60]!r}: install the ")
    assert changed(tmp_path, regressor__part=["Forest"]).startswith(
        "model.regressor: no known part"
    )
    told = changed(tmp_path, regressor={"part": "Lags", "samples": {"tuple": [0]}})
    assert told == "model.regressor.difference: missing"
    assert changed(tmp_path, regressor__colour=1) == (
        "model.regressor: unknown Forest field 'colour'"
    )


def test_arrays_are_named_once_and_all_of_them(tmp_path: Path) -> None:
    told = "model.regressor.left: names no array of this file"
    for value in ({"array": "x"}, {"array": "model.regressor.right", "more": 1}, {}, {"list": [1]},
                  {"tuple": 3}, {"tuple": [1], "more": 1}):  # fmt: skip
        assert changed(tmp_path, regressor__left=value) == told
    header, arrays = opened(KIND)
    spare = {**arrays, "b": np.zeros(1), "a": np.zeros(1)}
    told = refused(tmp_path, closed(header, spare))
    assert told == "holds the array 'a', which no field names"


def test_values_are_checked_whole_when_read_and_when_written(tmp_path: Path) -> None:
    assert changed(tmp_path, trained__min_m=1.0).startswith("trained.min_m, max_m: 1 to ")
    assert changed(tmp_path, regressor__weight=0.0).startswith("regressor.weight: 0 is not above 0")
    header, arrays = opened(KIND)
    arrays["model.regressor.feature"] += 10
    told = refused(tmp_path, closed(header, arrays))
    assert "is outside -1 .. " in told
    model = golden_forces.model(KIND)
    for part, changes, found in (
        ("trained", {"min_m": "x"}, "model.trained.min_m: 'x' is no finite number"),
        ("trained", {"min_m": 1.0}, "trained.min_m, max_m: 1 to "),
        ("regressor", {"feature": model.regressor.feature + np.int32(10)}, "regressor.feature: "),
    ):
        wrong = dataclasses.replace(
            model, **{part: dataclasses.replace(getattr(model, part), **changes)}
        )
        with pytest.raises(DataError) as error:
            model_bytes(wrong)
        assert str(error.value).startswith(f"{model.name}: {found}")
        assert str(error.value).endswith(": train on other recordings or options")


def test_what_stands_at_its_default_is_not_written(tmp_path: Path) -> None:
    model = golden_forces.model("hammerstein")
    passive = model.hammerstein
    for changes, written in (
        ({"n_by_depth": 0, "rate_ratio": 1.0, "recovers": False}, set()),
        (
            {"n_by_depth": 1, "rate_ratio": 2.0, "recovers": True},
            {"n_by_depth", "rate_ratio", "recovers"},
        ),
    ):
        other = dataclasses.replace(model, hammerstein=dataclasses.replace(passive, **changes))
        content = model_bytes(other)
        with np.load(io.BytesIO(content.partition(b"\n")[2])) as stored:
            header = json.loads(stored["header"].tobytes())
        found = {"n_by_depth", "rate_ratio", "recovers"} & set(header["hammerstein"])
        assert found == written
        (tmp_path / "x.spm").write_bytes(content)
        assert read_model(tmp_path / "x.spm").hammerstein.recovers == changes["recovers"]
    fixed = dataclasses.replace(model, provenance=MappingProxyType({"seed": 3}))
    (tmp_path / "x.spm").write_bytes(model_bytes(fixed))
    assert read_model(tmp_path / "x.spm").provenance == {"seed": 3}
    plain = dataclasses.replace(model, provenance={})
    content = model_bytes(plain)
    (tmp_path / "x.spm").write_bytes(content)
    assert read_model(tmp_path / "x.spm").provenance == {}


def test_a_part_of_ones_own_is_registered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model_file, "_PARTS", {})

    @dataclasses.dataclass
    class Own:
        number: float

    register_part(Own)
    assert model_file._PARTS["Own"] is Own


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    path = tmp_path / "none.spm"
    with refusing(DataError, f"{path}: cannot be read (No such file or directory)"):
        read_model(path)
