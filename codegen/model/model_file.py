"""Model files: one line of text with a checksum, then numpy arrays. Nothing in them executes.

The first line is `springpot-model SCHEMA SHA256`; the checksum covers every byte after it. The
rest is an npz: a JSON header, and the arrays that the header names.
"""

import hashlib
import io
import json
import re
import zipfile
from dataclasses import Field, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from springpot.codegen.entry_points import load_entries
from springpot.codegen.errors import DataError
from springpot.codegen.files import read_bounded, write_file
from springpot.codegen.model.features import (
    FastFirBank,
    FirBank,
    Lags,
    PositionVelocity,
    RecursiveBank,
)
from springpot.codegen.model.model import Model, TrainedRange
from springpot.codegen.model.passive import Damage, Flow, Hammerstein, Memory
from springpot.codegen.model.places import Places
from springpot.codegen.model.regressors import Expression, Forest, Linear, Quantisation, Rbf

MODEL_SCHEMA = 6
_OLD_SCHEMA = 5  # without the whole state: what begins at rest means the same
MODEL_MAGIC = b"springpot-model"
MODEL_SUFFIX = ".spm"
_UNIX = 3  # zip's number of the system that made an archive
_MAX_BYTES = 1 << 29  # a forest of 19 million nodes
_FILE_DESCRIPTION = "springpot model: `springpot train --out FILE.spm` makes one"
# The only types that a file can name; another package's kind adds its own with `register_part`.
_PARTS: dict[str, type] = {
    part.__name__: part
    for part in (
        Model, TrainedRange, Hammerstein, Flow, Damage, Memory, Places, FirBank, FastFirBank,
        RecursiveBank, Lags, PositionVelocity, Forest, Quantisation, Rbf, Linear,
        Expression,
    )
}  # fmt: skip

_Arrays = dict[str, NDArray[np.generic]]


def register_part(part: type) -> None:
    """Let model files hold this dataclass of arrays, numbers, strings and tuples.

    Call it in the module that the kind's entry point names: whoever reads a file loads no other.
    """
    _PARTS[part.__name__] = part


def model_hash(model: Model) -> str:
    """SHA-256 of everything in the model, independent of how a file packs it."""
    arrays: _Arrays = {}
    header = _pack(model, "model", arrays)
    digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
    for name in sorted(arrays):
        values = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode() + values.tobytes())
    return digest.hexdigest()


def write_model(path: Path, model: Model) -> str:
    """Write the model aside, rename it into place, and return its hash."""
    write_file(path, model_bytes(model))
    return model_hash(model)


def model_bytes(model: Model) -> bytes:
    """Return bytes of a model file: the line with the checksum, then the npz.

    Raises DataError for a model that `read_model` would refuse.
    """
    arrays: _Arrays = {}
    header = _pack(model, "model", arrays)
    try:
        model.require_valid()
    except DataError as error:
        raise DataError(f"{model.name}: {error}: train on other recordings or options") from None
    text = np.frombuffer(json.dumps(header, sort_keys=True).encode(), dtype=np.uint8)
    body = _zip_arrays({"header": text, **arrays})
    digest = hashlib.sha256(body).hexdigest().encode()
    return b"%s %d %s\n" % (MODEL_MAGIC, MODEL_SCHEMA, digest) + body


def _zip_arrays(arrays: _Arrays) -> bytes:
    """Pack arrays as numpy.savez_compressed does, into the same bytes on every system.

    numpy leaves the system that made a zip in it: the same arrays had another hash on Windows.
    """
    payload = io.BytesIO()
    with zipfile.ZipFile(payload, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in arrays.items():
            info = zipfile.ZipInfo(f"{name}.npy")
            info.create_system, info.compress_type = _UNIX, zipfile.ZIP_DEFLATED
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asanyarray(values), allow_pickle=False)
            archive.writestr(info, member.getvalue())
    return payload.getvalue()


def read_model(path: Path) -> Model:
    """Read a model file.

    Raises DataError if it is damaged, of another schema, or no model that can be rendered.
    """
    try:
        first_line, _, body = read_bounded(path, _MAX_BYTES, _FILE_DESCRIPTION).partition(b"\n")
    except OSError as error:
        raise DataError(
            f"{path}: cannot be read ({error.strerror}): give a {_FILE_DESCRIPTION}"
        ) from None
    header = re.fullmatch(MODEL_MAGIC + rb" ([0-9]{1,9}) ([0-9a-f]{64})", first_line)
    if not header:
        raise DataError(f"{path}: not a {_FILE_DESCRIPTION}")
    schema = int(header[1])
    if schema not in (_OLD_SCHEMA, MODEL_SCHEMA):
        raise DataError(
            f"{path}: model schema {schema}, this springpot reads {MODEL_SCHEMA}: upgrade "
            "springpot, or train again with this one"
        )
    if header[2] != hashlib.sha256(body).hexdigest().encode():
        raise DataError(f"{path}: damaged (checksum differs): copy it again or train again")
    try:
        with zipfile.ZipFile(io.BytesIO(body)) as archive:
            if sum(member.file_size for member in archive.infolist()) > _MAX_BYTES:
                raise DataError(f"unpacks to more than {_MAX_BYTES >> 20} MiB")
        with np.load(io.BytesIO(body), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        header = json.loads(arrays.pop("header").tobytes())
        if schema == _OLD_SCHEMA:
            _drop_old_memory(header)
        model = _unpack(header, arrays, "model")
        if not isinstance(model, Model):
            raise DataError("describes no model")
        _pack(model, "model", {})  # finite numbers alone, and known parts
        model.require_valid()
    except DataError as error:
        raise DataError(f"{path}: {error}: train again") from None
    # What another program wrote under a right checksum: numpy, zipfile and json raise these.
    except (
        ValueError, TypeError, AttributeError, KeyError, OSError, zipfile.BadZipFile, MemoryError,
        RecursionError,
    ) as error:  # fmt: skip
        reason = " ".join(str(error).split())[:200]
        raise DataError(f"{path}: holds no springpot model ({reason}): train again") from None
    return model


def _drop_old_memory(header: Any) -> None:
    """Take a part of a state out of a header of the old schema; raise DataError if it begins so."""
    passive = header["hammerstein"] or {}
    passive.pop("conditioned", None)
    if passive.pop("starts_conditioned", False):
        raise DataError("begins with a part of the object's state, as an older springpot wrote it")


def _pack(value: Any, path: str, arrays: _Arrays) -> object:
    """Return JSON of a part; its arrays go into `arrays` under their path."""
    if is_dataclass(value):
        name = type(value).__name__
        if name not in _PARTS:
            raise DataError(f"{path}: {name} is no known part: call register_part({name})")
        # What stands at its default is left out: a model's hash stays when parts gain fields.
        names = [item.name for item in fields(value) if not _is_default(value, item)]
        members = {name: _pack(getattr(value, name), f"{path}.{name}", arrays) for name in names}
        return {"part": name, **members}
    if isinstance(value, np.ndarray | float) and not np.isfinite(value).all():
        raise DataError(f"{path}: holds a number that is not finite: train on other recordings")
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": path}
    if isinstance(value, tuple):
        return {"tuple": list(value)}
    return dict(value) if path == "model.provenance" else value


def _is_default(part: Any, item: Field[Any]) -> bool:
    """Tell if a value is what a file without it means."""
    if "left_out" in item.metadata:
        return getattr(part, item.name) is None
    return isinstance(item.default, int | float) and getattr(part, item.name) == item.default


def _unpack(value: Any, arrays: _Arrays, path: str) -> Any:
    """Read the value of a field from JSON."""
    if not isinstance(value, dict) or path == "model.provenance":
        return value
    if "tuple" in value:
        return tuple(value["tuple"])
    if "array" in value:
        return arrays[value["array"]]
    name = value.pop("part")
    if name not in _PARTS:
        load_entries("kinds", object)  # another package's kind brings parts of its own
    if name not in _PARTS:
        raise DataError(f"{path}: no known part {name!r}: install the package that adds its kind")
    inside = {field: _unpack(item, arrays, f"{path}.{field}") for field, item in value.items()}
    return _PARTS[name](**inside)
