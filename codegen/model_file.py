"""Model files: one line of text with a checksum, then numpy arrays. Nothing in them executes.

The first line is `springpot-model SCHEMA SHA256`; the checksum covers every byte after it. The
rest is an npz: a JSON header and the arrays that it does not spell out.
"""

import hashlib
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.ir import FirBank, Forest, Model, TrainedRange
from springpot.runtime_c.errors import DataError

SCHEMA = 1
MAGIC = b"springpot-model"
SUFFIX = ".spm"
_FOREST_ARRAYS = ("feature", "threshold", "left", "right", "value_n", "roots")


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
    header, arrays = _to_parts(model)
    payload = io.BytesIO()
    text = np.frombuffer(json.dumps(header, sort_keys=True).encode(), dtype=np.uint8)
    np.savez_compressed(payload, allow_pickle=False, header=text, **arrays)
    body = payload.getvalue()
    first_line = b"%s %d %s\n" % (MAGIC, SCHEMA, hashlib.sha256(body).hexdigest().encode())
    aside = path.with_name(path.name + ".part")
    aside.write_bytes(first_line + body)
    aside.replace(path)
    return model_hash(model)


def read_model(path: Path) -> Model:
    """Read a model file. Raises DataError where it is damaged, of a later schema, or none."""
    try:
        first_line, _, body = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from None
    words = first_line.split(b" ")
    if len(words) != 3 or words[0] != MAGIC or not words[1].isdigit():
        raise DataError(
            f"{path}: not a springpot model: `springpot train --out FILE.spm` makes one"
        )
    if int(words[1]) > SCHEMA:
        raise DataError(
            f"{path}: model schema {int(words[1])}, this springpot reads up to {SCHEMA}: "
            "upgrade springpot, or train again with this one"
        )
    if words[2] != hashlib.sha256(body).hexdigest().encode():
        raise DataError(f"{path}: damaged (checksum differs): copy it again or train again")
    with np.load(io.BytesIO(body), allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    return _from_parts(json.loads(arrays.pop("header").tobytes()), arrays)


def _to_parts(model: Model) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    header = {
        "kind": model.kind,
        "name": model.name,
        "dt_s": model.dt_s,
        "contact": model.contact,
        "trained": vars(model.trained),
        "orders": list(model.features.orders),
        "provenance": dict(model.provenance),
    }
    arrays = {name: getattr(model.regressor, name) for name in _FOREST_ARRAYS}
    return header, {"taps": model.features.taps, **arrays}


def _from_parts(header: dict[str, Any], arrays: dict[str, np.ndarray[Any, Any]]) -> Model:
    return Model(
        kind=header["kind"],
        name=header["name"],
        dt_s=header["dt_s"],
        contact=header["contact"],
        trained=TrainedRange(**header["trained"]),
        features=FirBank(orders=tuple(header["orders"]), taps=arrays["taps"]),
        regressor=Forest(**{name: arrays[name] for name in _FOREST_ARRAYS}),
        provenance=header["provenance"],
    )
