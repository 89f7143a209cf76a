"""Model files: one line of text with a checksum, then numpy arrays. Nothing in them executes.

The first line is `springpot-model SCHEMA SHA256`; the checksum covers every byte after it. The
rest is an npz: a JSON header and the arrays that it does not spell out.
"""

import hashlib
import io
import json
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.atomic_write import write_file
from springpot.codegen.errors import DataError
from springpot.codegen.model.features import (
    FastFirBank,
    FirBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.model import Hammerstein, Model, TrainedRange
from springpot.codegen.model.regressors import Forest, Quantisation, Rbf

MODEL_SCHEMA = 3  # 1: forests without quantisation; 2: other names of fields
MODEL_MAGIC = b"springpot-model"
MODEL_SUFFIX = ".spm"
# The only types that a file can name; a kind of one's own adds its own with `register_part`.
_PARTS: dict[str, type[Any]] = {
    part.__name__: part
    for part in (
        Model, TrainedRange, Hammerstein, FirBank, FastFirBank, RecursiveBank, Lags,
        PositionVelocity, Forest, Quantisation, Rbf,
    )
}  # fmt: skip


# Names of schema 2: of parts, and of the fields of a part.
_FORMER_PARTS = {"Rounding": "Quantisation"}
_FORMER_FIELDS = {
    "TrainedRange": {
        "least_m": "min_m", "greatest_m": "max_m", "greatest_mps": "max_mps",
        "least_n": "min_n", "greatest_n": "max_n",
    },
    "Forest": {"rounding": "quantisation"},
    "Quantisation": {"least": "feature_min", "per_step": "bins_per_unit"},
    "Rbf": {"least": "feature_min", "greatest": "feature_max"},
}  # fmt: skip


def register_part(part: type[Any]) -> None:
    """Let model files hold this dataclass of arrays, numbers, strings and tuples."""
    _PARTS[part.__name__] = part


def model_hash(model: Model) -> str:
    """SHA-256 of everything in the model, independent of how a file packs it."""
    header, arrays = _to_parts(model)
    digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name in sorted(arrays):
        values = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
        digest.update(values.tobytes())
    return digest.hexdigest()


def write_model(path: Path, model: Model) -> str:
    """Write the model aside, rename it into place, and return its hash."""
    write_file(path, model_bytes(model))
    return model_hash(model)


def model_bytes(model: Model) -> bytes:
    """What `write_model` writes: the line with the checksum, then the npz."""
    header, arrays = _to_parts(model)
    payload = io.BytesIO()
    text = np.frombuffer(json.dumps(header, sort_keys=True).encode(), dtype=np.uint8)
    np.savez_compressed(payload, allow_pickle=False, header=text, **arrays)
    body = payload.getvalue()
    return (
        b"%s %d %s\n" % (MODEL_MAGIC, MODEL_SCHEMA, hashlib.sha256(body).hexdigest().encode())
        + body
    )


def read_model(path: Path) -> Model:
    """Read a model file. Raises DataError where it is damaged, of a later schema, or none."""
    try:
        first_line, _, body = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from None
    words = first_line.split(b" ")
    if len(words) != 3 or words[0] != MODEL_MAGIC or not words[1].isdigit():
        raise DataError(
            f"{path}: not a springpot model: `springpot train --out FILE.spm` makes one"
        )
    if int(words[1]) > MODEL_SCHEMA:
        raise DataError(
            f"{path}: model schema {int(words[1])}, this springpot reads up to {MODEL_SCHEMA}: "
            "upgrade springpot, or train again with this one"
        )
    if words[2] != hashlib.sha256(body).hexdigest().encode():
        raise DataError(f"{path}: damaged (checksum differs): copy it again or train again")
    with np.load(io.BytesIO(body), allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    model = _from_parts(json.loads(arrays.pop("header").tobytes()), arrays)
    assert isinstance(model, Model)
    return model


Arrays = dict[str, np.ndarray[Any, Any]]


def _to_parts(model: Model) -> tuple[Any, Arrays]:
    arrays: Arrays = {}
    return _packed(model, "model", arrays), arrays


def _packed(value: Any, path: str, arrays: Arrays) -> Any:
    """JSON of a part; its arrays go into `arrays` under their path."""
    if is_dataclass(value):
        names = [field.name for field in fields(value)]
        inside = {name: _packed(getattr(value, name), f"{path}.{name}", arrays) for name in names}
        return {"part": type(value).__name__, **inside}
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": path}
    if isinstance(value, tuple):
        return {"tuple": list(value)}
    return dict(value) if path == "model.provenance" else value


def _from_parts(value: Any, arrays: Arrays) -> Any:
    if isinstance(value, dict) and "part" in value:
        named: str = value["part"]
        part = _FORMER_PARTS.get(named, named)
        now = _FORMER_FIELDS.get(part, {})
        inside: dict[str, Any] = {
            str(now.get(name, name)): item if name == "provenance" else _from_parts(item, arrays)
            for name, item in value.items()
            if name != "part"
        }
        return _PARTS[part](**inside)
    if isinstance(value, dict):
        return tuple(value["tuple"]) if "tuple" in value else arrays[value["array"]]
    return value
