"""Model files that strangers made, their checksum right: one line each, and nothing is taken."""

import hashlib
import io
import resource
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.c import golden_forces
from support.files.hostile_models import hostile_models

from springpot.codegen.errors import DataError
from springpot.codegen.model.field_types import MAX_NUMBER
from springpot.codegen.model.model_file import MODEL_MAGIC, MODEL_SCHEMA, model_bytes, read_model


@pytest.fixture
def little_memory() -> Iterator[None]:
    """Whoever takes more than a GiB beyond what the process has is out of memory."""
    usual = resource.getrlimit(resource.RLIMIT_AS)
    has = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (has + (1 << 30), usual[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, usual)


@pytest.mark.usefixtures("little_memory")
def test_none_is_taken_and_each_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "hostile.spm"
    wrong, n = [], 0
    for hostile in hostile_models():
        n += 1
        file.write_bytes(hostile.content)
        try:
            read_model(file)
            wrong.append(f"taken: {hostile.what}")
        except DataError as error:
            line = str(error)
            if not line.startswith(f"{file}: ") or not line.isprintable() or len(line) > 700:
                wrong.append(f"{hostile.what}: {line[:200]!r}")
        except Exception as error:
            wrong.append(f"{hostile.what}: {error!r}"[:300])
    assert not wrong, "\n".join(wrong)
    assert n > 500


def test_what_would_be_refused_is_not_written() -> None:
    model = golden_forces.model("rf-fd")
    forest = model.regressor
    object.__setattr__(forest, "threshold", np.full_like(forest.threshold, 2 * MAX_NUMBER))
    with pytest.raises(DataError, match=r"rf-fd: model\.regressor\.threshold: a number that"):
        model_bytes(model)


@pytest.mark.parametrize(
    ("array", "told"),
    [
        (np.zeros(20_000_000, np.int32), "declares 76 MiB, more than 64"),
        (np.frombuffer(b"[" + b"[]," * 2_000_000 + b"[]]", np.uint8), "header: 5 MiB, more than 4"),
    ],
)
def test_a_small_file_takes_little_memory(tmp_path: Path, array: np.ndarray, told: str) -> None:
    payload = io.BytesIO()
    np.savez_compressed(payload, allow_pickle=False, header=array)
    body = payload.getvalue()
    checksum = hashlib.sha256(body).hexdigest().encode()
    file = tmp_path / "small.spm"
    file.write_bytes(b"%s %d %s\n" % (MODEL_MAGIC, MODEL_SCHEMA, checksum) + body)
    with pytest.raises(DataError, match=told):
        read_model(file)
