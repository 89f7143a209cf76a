"""Model files: one line of text with a checksum, then numpy arrays. Nothing in them executes.

The first line is `springpot-model SCHEMA SHA256`; the checksum covers every byte after it. The
rest is an npz: a JSON header and the arrays that it does not spell out. Whoever can compute SHA-256
can make such a file: the whole model is checked when it is read, and when it is written.
"""

import hashlib
import io
import json
import re
from dataclasses import Field, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.atomic_write import write_file
from springpot.codegen.entry_points import registered
from springpot.codegen.errors import DataError
from springpot.codegen.model.features import (
    FastFirBank,
    FirBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.field_types import require_types
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.packed_arrays import MAX_BYTES, Arrays, unpacked
from springpot.codegen.model.passive import Damage, Flow, Hammerstein
from springpot.codegen.model.places import Places
from springpot.codegen.model.regressors import Forest, Quantisation, Rbf
from springpot.codegen.model.validity import require_valid
from springpot.codegen.regular_file import read_bounded

MODEL_SCHEMA = 5
MODEL_MAGIC = b"springpot-model"
MODEL_SUFFIX = ".spm"
_WHAT = "springpot model: `springpot train --out FILE.spm` makes one"
_MAX_HEADER_BYTES = 4 << 20  # JSON becomes a hundred times as much memory
# The only types that a file can name; a kind of one's own adds its own with `register_part`.
_PARTS: dict[str, type[Any]] = {
    part.__name__: part
    for part in (
        Model, TrainedRange, Hammerstein, Flow, Damage, Places, FirBank, FastFirBank, RecursiveBank,
        Lags, PositionVelocity, Forest, Quantisation, Rbf,
    )
}  # fmt: skip


class _UnknownPartError(DataError):
    """A part that no package here brings."""


def register_part(part: type[Any]) -> None:
    """Let model files hold this dataclass of arrays, numbers, strings and tuples.

    Call it in the module that the kind's entry point names: whoever reads a file loads no other.
    """
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
    """Bytes of a model file: the line with the checksum, then the npz.

    Raises DataError for a model that `read_model` would refuse.
    """
    try:
        _require_types_within(model, "model")
        require_valid(model, _n_features(model))
    except DataError as error:
        raise DataError(f"{model.name}: {error}: train on other recordings or options") from None
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
    """Read a model file and check all that is in it.

    Raises DataError if it is damaged, of another schema, or no model that can be rendered.
    """
    try:
        first_line, _, body = read_bounded(path, MAX_BYTES, _WHAT).partition(b"\n")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}): give a {_WHAT}") from None
    words = first_line.split(b" ")
    if len(words) != 3 or words[0] != MODEL_MAGIC or not re.fullmatch(rb"[0-9]{1,9}", words[1]):
        raise DataError(f"{path}: not a {_WHAT}")
    if int(words[1]) != MODEL_SCHEMA:
        raise DataError(
            f"{path}: model schema {int(words[1])}, this springpot reads {MODEL_SCHEMA}: upgrade "
            "springpot, or train again with this one"
        )
    if words[2] != hashlib.sha256(body).hexdigest().encode():
        raise DataError(f"{path}: damaged (checksum differs): copy it again or train again")
    try:
        return _model(unpacked(body))
    except _UnknownPartError as error:
        raise DataError(
            f"{path}: {error}: install the package that adds this kind, whose entry point's "
            "module has to call register_part, or train again"
        ) from None
    except DataError as error:
        raise DataError(
            f"{path}: {error}: springpot never writes such a model, train again"
        ) from None


def _model(arrays: Arrays) -> Model:
    """The model in the arrays. Raises DataError, without the file's name, where there is none."""
    header = arrays.pop("header", np.zeros(0))
    if header.nbytes > _MAX_HEADER_BYTES:
        raise DataError(f"header: {header.nbytes >> 20} MiB, more than {_MAX_HEADER_BYTES >> 20}")
    try:
        parts = json.loads(header.tobytes(), parse_constant=_no_number)
        used: set[str] = set()
        model = _from_parts(parts, arrays, "model", used)
    except DataError:
        raise
    except (ValueError, RecursionError) as error:
        raise DataError(f"header: no JSON ({' '.join(str(error).split())[:200]})") from None
    if not isinstance(model, Model):
        raise DataError("header: describes no model")
    if unused := sorted(set(arrays) - used):
        raise DataError(f"holds the array {unused[0]!r}, which no field names")
    require_valid(model, _n_features(model))
    return model


def _no_number(name: str) -> float:
    raise DataError(f"header: {name} is no number of JSON")


def _n_features(model: Model) -> int:
    return 0 if model.features is None else model.features.n_features


def _require_types_within(part: Any, where: str) -> None:
    inside = {field.name: getattr(part, field.name) for field in fields(part)}
    require_types(type(part), inside, where)
    for name, value in inside.items():
        if is_dataclass(value):
            _require_types_within(value, f"{where}.{name}")


def _to_parts(model: Model) -> tuple[Any, Arrays]:
    arrays: Arrays = {}
    return _packed(model, "model", arrays), arrays


def _packed(value: Any, path: str, arrays: Arrays) -> Any:
    """JSON of a part; its arrays go into `arrays` under their path."""
    if is_dataclass(value):
        name = type(value).__name__
        if name not in _PARTS:
            raise DataError(f"{path}: {name} is no known part: call register_part({name})")
        # What stands at its default is left out: a model's hash stays when parts learn more.
        names = [item.name for item in fields(value) if not _at_default(value, item)]
        inside = {name: _packed(getattr(value, name), f"{path}.{name}", arrays) for name in names}
        return {"part": name, **inside}
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": path}
    if isinstance(value, tuple):
        return {"tuple": list(value)}
    return dict(value) if path == "model.provenance" else value


def _at_default(part: Any, item: Field[Any]) -> bool:
    """Whether a value is what a file without it means."""
    if "left_out" in item.metadata:
        return getattr(part, item.name) is None
    return isinstance(item.default, int | float) and getattr(part, item.name) == item.default


def _from_parts(value: Any, arrays: Arrays, where: str, used: set[str]) -> Any:
    """The value of a field out of its JSON; `used` gathers the names of the arrays taken."""
    if not isinstance(value, dict):
        return value
    if where == "model.provenance":
        return value
    if "part" in value:
        name = str(value["part"])
        if name not in _PARTS:
            registered("kinds", object)  # another package's kind brings parts of its own
        if name not in _PARTS:
            raise _UnknownPartError(f"{where}: no known part {name[:60]!r}")
        inside: dict[str, Any] = {
            str(field): _from_parts(item, arrays, f"{where}.{field}", used)
            for field, item in value.items()
            if field != "part"
        }
        require_types(_PARTS[name], inside, where)  # before anything is made of them
        return _PARTS[name](**inside)
    if list(value) == ["tuple"] and isinstance(value["tuple"], list):
        return tuple(value["tuple"])
    stored = str(value.get("array"))
    if list(value) != ["array"] or stored not in arrays:
        raise DataError(f"{where}: names no array of this file")
    used.add(stored)
    return arrays[stored]
