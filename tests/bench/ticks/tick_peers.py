"""The forest alone by others: tl2cgen, ONNX Runtime on one thread, scikit-learn itself."""

import time
from pathlib import Path
from typing import Any

import numpy as np

ROWS = 200


def peer_rows(ensemble: Any, features: np.ndarray, folder: Path) -> list[dict[str, Any]]:
    """Rows of the table; a peer that is not installed is left out, and said so."""
    found = []
    for name, peer in (("tl2cgen", _tl2cgen), ("onnxruntime", _onnx), ("scikit-learn", _sklearn)):
        try:
            found.append(_row(name, *peer(ensemble, features, folder)))
        except ImportError as error:
            print(f"{name}: not installed ({error.name})")
    return found


def _row(
    what: str, hot_ns: float, size: int | None, write_s: float, compile_s: float | None
) -> dict:
    return {"what": what, "hot_ns": hot_ns, "paced_p50_ns": None, "paced_p99_ns": None,
            "instructions": None, "bytes": size, "write_s": write_s,
            "compile_s": compile_s}  # fmt: skip


def _median_ns(call: Any, features: np.ndarray) -> float:
    times = []
    for row in features[:ROWS]:
        one = row[None, :]
        begin = time.perf_counter_ns()
        call(one)
        times.append(time.perf_counter_ns() - begin)
    return float(np.median(times))


def _tl2cgen(ensemble: Any, features: np.ndarray, folder: Path) -> tuple[float, int, float, float]:
    import ctypes

    import tl2cgen
    import treelite

    model = treelite.sklearn.import_model(ensemble)
    begin = time.perf_counter()
    tl2cgen.generate_c_code(model, dirpath=str(folder / "tl2cgen"), params={"parallel_comp": 8})
    write_s = time.perf_counter() - begin
    begin = time.perf_counter()
    built = tl2cgen.create_shared("gcc", str(folder / "tl2cgen"), nthread=1)
    compile_s = time.perf_counter() - begin
    library = ctypes.CDLL(str(built))

    class Entry(ctypes.Union):
        _fields_ = [("missing", ctypes.c_int), ("value", ctypes.c_double)]

    # Called many times on one vector and divided: a call from Python costs more than the forest.
    entries = [(Entry * features.shape[1])(*[Entry(value=float(x)) for x in row])
               for row in features[:ROWS]]  # fmt: skip
    result = (ctypes.c_double * 1)()
    predict = library.predict
    empty_ns = min(_call_ns(library.get_num_feature, entries, result) for _ in range(20))
    times = [_call_ns(predict, entries, result) for _ in range(20)]
    return float(np.median(times)) - empty_ns, Path(built).stat().st_size, write_s, compile_s


def _call_ns(function: Any, entries: list[Any], result: Any) -> float:
    begin = time.perf_counter_ns()
    for entry in entries:
        function(entry, 0, result)
    return (time.perf_counter_ns() - begin) / len(entries)


def _onnx(ensemble: Any, features: np.ndarray, folder: Path) -> tuple[float, int, float, None]:
    import onnxruntime
    from skl2onnx import to_onnx

    begin = time.perf_counter()
    text = to_onnx(ensemble, features[:1].astype(np.float32)).SerializeToString()
    write_s = time.perf_counter() - begin
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(text, options, providers=["CPUExecutionProvider"])
    name = session.get_inputs()[0].name
    return (
        _median_ns(lambda one: session.run(None, {name: one}), features),
        len(text),
        write_s,
        None,
    )


def _sklearn(ensemble: Any, features: np.ndarray, folder: Path) -> tuple[float, None, float, None]:
    ensemble.n_jobs = 1
    return _median_ns(ensemble.predict, features), None, 0.0, None
