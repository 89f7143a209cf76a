"""Model files: the parts of the npz, packed again with right checksums, or its raw bytes."""

import hashlib
import io
import zipfile
from collections.abc import Iterator
from pathlib import Path

from proof.fuzz.reader import Reader, joined, split
from support.c import golden_forces
from support.small import small_model

from springpot.codegen.model.model_file import MODEL_MAGIC, MODEL_SCHEMA, model_bytes, read_model

_SMALL = ("hammerstein", "springpot", "rbf-pv", "rbf-fd", "rf-fd-fast")


def seeds() -> Iterator[tuple[str, bytes]]:
    """Models of every small kind, in parts; one as its npz."""
    bodies = {name: model_bytes(golden_forces.model(name)) for name in _SMALL}
    bodies["forest"] = model_bytes(small_model())
    for name, content in bodies.items():
        body = content.partition(b"\n")[2]
        with zipfile.ZipFile(io.BytesIO(body)) as stored:
            parts = [
                entry.filename.encode() + b"\n" + stored.read(entry) for entry in stored.infolist()
            ]
        yield name, joined(parts)
    yield "npz", bodies["springpot"].partition(b"\n")[2]


def body_of(content: bytes) -> bytes:
    """The npz of what the fuzzer made, raw or of its parts."""
    if content.startswith(b"PK"):
        return content
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as stored:
        for part in split(content):
            name, _, values = part.partition(b"\n")
            stored.writestr(name.decode("latin-1").replace("\0", "") or "unnamed", values)
    return memory.getvalue()


def read(content: bytes, folder: Path) -> None:
    """Read a model file with the right checksum; what is taken must be written again."""
    body = body_of(content)
    checksum = hashlib.sha256(body).hexdigest().encode()
    file = folder / "model.spm"
    file.write_bytes(b"%s %d %s\n" % (MODEL_MAGIC, MODEL_SCHEMA, checksum) + body)
    model_bytes(read_model(file))


READER = Reader(
    seeds,
    read,
    words=(
        '"part": "', '"array": "', '"tuple": [', "Model", "Hammerstein", "TrainedRange", "FirBank",
        "FastFirBank", "RecursiveBank", "Lags", "PositionVelocity", "Forest", "Quantisation", "Rbf",
        "provenance", "1e999", "-1e308", "1e-320", "null", "true", "'shape': (", "'<f8'", "'<i4'",
    ),
)  # fmt: skip
