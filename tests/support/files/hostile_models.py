"""Hostile model files: real ones, each made wrong in one known way, their checksum right."""

import copy
import hashlib
import io
import json
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from springpot.codegen.model.model_file import model_bytes
from support.c.golden_forces import model

Header = dict[str, Any]
Arrays = dict[str, np.ndarray]
_WHOLE = "rf-fd"  # the model of which every field is changed
NOT_FINITE = (float("nan"), float("inf"), -float("inf"), 1e200)


@dataclass(frozen=True)
class HostileModel:
    what: str
    content: bytes


def signed(body: bytes) -> bytes:
    """A model file of this body: anyone can compute the checksum."""
    return b"springpot-model 5 %s\n" % hashlib.sha256(body).hexdigest().encode() + body


def opened(name: str) -> tuple[Header, Arrays]:
    return copy.deepcopy(_opened(name))


@cache
def _opened(name: str) -> tuple[Header, Arrays]:
    """Header and arrays of a stored model, by today's names."""
    body = model_bytes(model(name)).partition(b"\n")[2]
    with np.load(io.BytesIO(body)) as stored:
        arrays = {name: stored[name] for name in stored.files}
    return json.loads(arrays.pop("header").tobytes()), arrays


def closed(header: Any, arrays: Arrays) -> bytes:
    text = header if isinstance(header, str) else json.dumps(header)
    memory = io.BytesIO()
    np.savez(memory, header=np.frombuffer(text.encode(), np.uint8), **arrays)
    return signed(memory.getvalue())


def hostile_models() -> Iterator[HostileModel]:
    for name in ("rf-fd", "rf-fd-quantised", "rbf-fd-fast", "rbf-pv",
                 "rf-fd-long", "springpot"):  # fmt: skip
        yield from _changed_fields(name)
        yield from _changed_arrays(name)
    yield from _trees()
    yield from _words_and_provenance()
    yield from _archives()


def _changed(name: str, what: str, change: Callable[[Header, Arrays], Any]) -> HostileModel:
    header, arrays = opened(name)
    change(header, arrays)
    return HostileModel(f"{name}: {what}", closed(header, arrays))


def _set(name: str, path: str, value: Any) -> HostileModel:
    """`path`: of an element of the header, as in "trained.min_m"."""

    def change(header: Header, arrays: Arrays) -> None:
        *outer, last = path.split(".")
        for key in outer:
            header = header[key]
        header[last] = value

    return _changed(name, f"{path} = {str(value)[:40]}", change)


def _put(name: str, array: str, at: Any, value: float) -> HostileModel:
    def change(header: Header, arrays: Arrays) -> None:
        arrays[f"model.{array}"][at] = value

    return _changed(name, f"{array}[{at}] = {value}", change)


def _scalars(header: Header, path: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in header.items():
        if key in ("part", "provenance") or (isinstance(value, dict) and "array" in value):
            continue
        if isinstance(value, dict) and "part" in value:
            yield f"{path}{key}", value
            yield from _scalars(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value


# Fields with a default.
_MAY_BE_ABSENT = {"regressor.quantisation", "hammerstein.flow", "hammerstein.damage",
                  "hammerstein.recovers"}  # fmt: skip


def _changed_fields(name: str) -> Iterator[HostileModel]:
    """Every field of every part: left out, of another type, not finite."""
    for path, value in _scalars(opened(name)[0]):
        if _told_already(name, path):
            continue
        for wrong in ([], {"array": "model.none"}, {"part": "Model"}, {"part": "os"}, "\n"):
            yield _set(name, path, wrong)
        if isinstance(value, float):
            for number in NOT_FINITE:
                yield _set(name, path, number)
            yield _set(name, path, "1")
        if isinstance(value, bool):
            yield _set(name, path, 1)
        elif isinstance(value, int):
            yield _set(name, path, 1.5)
            yield _set(name, path, -1)
            yield _set(name, path, 10**400)
        if path not in _MAY_BE_ABSENT:
            yield _changed(name, f"no {path}", lambda h, _, path=path: _remove(h, path))


def _changed_arrays(name: str) -> Iterator[HostileModel]:
    """Every array: left out, of another type or shape, not finite."""
    for array, values in opened(name)[1].items():
        field = array.removeprefix("model.")
        if not values.size or _told_already(name, field):
            continue
        yield _changed(name, f"no {array}", lambda _, a, array=array: a.pop(array))
        for dtype in ("f4", "i8", "c16", ">f8", "U4", "?"):
            if np.dtype(dtype) != values.dtype:
                yield _changed(
                    name, f"{array} of {dtype}",
                    lambda _, a, n=array, d=dtype: a.update({n: a[n].astype(d)}),
                )  # fmt: skip
        yield _changed(name, f"{array} nested", lambda _, a, n=array: a.update({n: a[n][None]}))
        if field == "features.tau_ticks":
            continue  # with one row less, one tap more is direct: another model, and a whole one
        yield _changed(name, f"{array} short", lambda _, a, n=array: a.update({n: a[n][..., :-1]}))
        yield _changed(name, f"{array} empty", lambda _, a, n=array: a.update({n: a[n][:0]}))
        if values.dtype == np.float64:
            for number in NOT_FINITE:
                yield _put(name, field, -1, number)


def _told_already(name: str, field: str) -> bool:
    """Whether another model's fields say the same: all have one header and one passive model."""
    return name != _WHOLE and not field.startswith(("features", "regressor"))


def _remove(header: Header, path: str) -> None:
    *outer, last = path.split(".")
    for key in outer:
        header = header[key]
    del header[last]


def _trees() -> Iterator[HostileModel]:
    arrays = opened("rf-fd")[1]
    feature = arrays["model.regressor.feature"]
    root, inner = 0, int(np.flatnonzero(feature >= 0)[5])
    leaf = int(np.flatnonzero(feature < 0)[0])
    for column in (-9, -2, 10, 2**31 - 1):
        yield _put("rf-fd", "regressor.feature", inner, column)
    for side in ("left", "right"):
        for node, child in ((inner, -1), (inner, inner), (inner, root), (inner, 10**6), (leaf, -5),
                            (leaf, 10**6), (inner, leaf)):  # fmt: skip
            if arrays[f"model.regressor.{side}"][node] != child:
                yield _put("rf-fd", f"regressor.{side}", node, child)
    yield _put("rf-fd", "regressor.roots", 1, 0)
    yield _put("rf-fd", "regressor.roots", 1, -1)
    yield _put("rf-fd", "regressor.roots", 1, 10**6)
    yield _put("rf-fd", "regressor.feature", inner, -1)  # its children are orphans
    yield HostileModel("rf-fd: a cycle beside the trees", _with_trees(_ring))
    yield HostileModel("rf-fd: a tree 100 000 deep", _with_trees(lambda t: _chain(t, 100_000)))
    yield _set("rf-fd", "regressor.weight", 0.0)
    yield _set("rf-fd", "regressor.weight", -1.0)


def _with_trees(change: Callable[[Arrays], None]) -> bytes:
    header, arrays = opened("rf-fd")
    change(arrays)
    return closed(header, arrays)


def _replace_trees(arrays: Arrays, feature: Any, left: Any, right: Any) -> None:
    n = len(feature)
    arrays |= {
        "model.regressor.feature": np.array(feature, np.int32),
        "model.regressor.left": np.array(left, np.int32),
        "model.regressor.right": np.array(right, np.int32),
        "model.regressor.threshold": np.zeros(n),
        "model.regressor.value_n": np.zeros(n),
        "model.regressor.roots": np.zeros(1, np.int32),
    }


def _ring(arrays: Arrays) -> None:
    """A leaf as the only tree, and two nodes that are each other's children, with two leaves."""
    _replace_trees(arrays, [-1, 0, 0, -1, -1], [0, 2, 1, 0, 0], [0, 3, 4, 0, 0])


def _chain(arrays: Arrays, depth: int) -> None:
    """Node 2 k splits into leaf 2 k + 1 and node 2 k + 2."""
    n = 2 * depth + 1
    inner = (np.arange(n) % 2 == 0) & (np.arange(n) < n - 1)
    left, right = np.where(inner, np.arange(n) + 1, 0), np.where(inner, np.arange(n) + 2, 0)
    _replace_trees(arrays, np.where(inner, 0, -1), left, right)


def _words_and_provenance() -> Iterator[HostileModel]:
    for path, value in (
        ("contact", "junk"), ("kind", "x; rm -rf ~"), ("name", "\ud800"), ("name", "\x1b[31m"),
        ("provenance", []), ("provenance", {"seed": "0"}),
        ("provenance", {"rows_total": -1}), ("provenance", {"rows": True}),
        ("provenance", {"smooth_s": "0.025"}), ("provenance", {"smooth_s": -1}),
        ("provenance", {"recordings": ["press"]}),
        ("provenance", {"recordings": {"press": {}}}),
        ("provenance", {"importance": {"0": 1}}),
        ("provenance", {"importance": ["1"]}),
        ("surprise", 1.0),
        ("part", "TrainedRange"), ("part", "os"),
    ):  # fmt: skip
        yield _set("rf-fd", path, value)
    yield _changed("rf-fd", "an array too many", lambda _, a: a.update(extra=np.zeros(3)))


def _archives() -> Iterator[HostileModel]:
    """What declares more than it holds, or more than a machine has."""
    yield HostileModel("no archive", signed(b"PK"))
    yield HostileModel("an empty archive", signed(_zip({})))
    _, arrays = opened("rf-fd")
    for what, header in (
        ("no JSON", "{"), ("a list", "[1, 2]"), ("null", "null"), ("a number too long", "9" * 9999),
        ("nested", "[" * 100_000), ("parts nested", '{"part":' * 5000),
        ("a part that is a list", '{"part": []}'),
        ("1e999", '{"part": "Model", "dt_s": 1e999}'),
    ):  # fmt: skip
        yield HostileModel(f"header: {what}", closed(header, arrays))
    header, arrays = opened("rf-fd")
    files = {f"{name}.npy": _npy(values) for name, values in arrays.items()}
    files["header.npy"] = _npy(np.frombuffer(json.dumps(header).encode(), np.uint8))
    taps = "model.features.taps.npy"
    for what, shape in (("40 GiB", "(5368709120,)"), ("2 ** 70", "(1180591620717411303424,)")):
        lie = _npy_header("<f8", shape) + bytes(171 * 80)
        yield HostileModel(f"an array that declares {what}", signed(_zip(files | {taps: lie})))
    honest = _zip(files)
    yield HostileModel("40 GiB declared by the archive", signed(_with_size(honest, taps, 40 << 30)))
    yield HostileModel("a length too short", signed(_with_size(honest, taps, 5000)))


def _npy(values: np.ndarray) -> bytes:
    memory = io.BytesIO()
    np.lib.format.write_array(memory, values, version=(1, 0))
    return memory.getvalue()


def _npy_header(dtype: str, shape: str) -> bytes:
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def _zip(files: dict[str, bytes]) -> bytes:
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return memory.getvalue()


def _with_size(archive: bytes, name: str, size: int) -> bytes:
    """The central directory says `size` of this entry (in its 32 bits)."""
    at = archive.rindex(name.encode()) - 46 + 24
    return archive[:at] + min(size, 2**32 - 2).to_bytes(4, "little") + archive[at + 4 :]
