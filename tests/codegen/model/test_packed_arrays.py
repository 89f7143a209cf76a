"""Arrays in an npz: what numpy writes is read, and what declares more than it holds is not."""

import io
import struct
import zipfile

import numpy as np
import pytest

from springpot.codegen import regular_file
from springpot.codegen.errors import DataError
from springpot.codegen.model import packed_arrays
from springpot.codegen.model.packed_arrays import unpacked

START = b"\x93NUMPY\x01\x00"


def npz(*arrays: tuple[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", method) as archive:
        for name, content in arrays:
            archive.writestr(name, content)
    return memory.getvalue()


def npy(header: str, content: bytes = b"", start: bytes = START) -> bytes:
    text = header.encode()
    return start + struct.pack("<H", len(text)) + text + content


def described(descr: str, shape: str, fortran: bool = False) -> str:
    return f"{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': ({shape}), }}\n"


def refused(body: bytes) -> str:
    with pytest.raises(DataError) as error:
        unpacked(body)
    told = str(error.value)
    assert told.isprintable()
    assert told.startswith("its arrays cannot be read (")
    return told.removeprefix("its arrays cannot be read (").removesuffix(")")


def test_a_name_keeps_all_but_its_ending_and_a_shape_may_have_eighty_letters() -> None:
    packed = npy(described("<f8", "1," + " " * 78), bytes(8))
    found = unpacked(npz(("a.npy.npy", packed)))
    assert {name: array.shape for name, array in found.items()} == {"a.npy": (1,)}


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_what_numpy_writes_is_read(save) -> None:
    arrays = {
        "reals": np.arange(6.0).reshape(2, 3),
        "columns": np.asfortranarray(np.arange(6, dtype=np.int32).reshape(2, 3)),
        "bytes": np.frombuffer(b"text", np.uint8),
        "one": np.array(1.5),
        "none": np.zeros((0, 3)),
        "yes": np.array([True, False]),
        "big": np.arange(3, dtype=">i4"),
    }
    memory = io.BytesIO()
    save(memory, **arrays)
    found = unpacked(memory.getvalue())
    assert list(found) == list(arrays)
    for name, expected in arrays.items():
        assert found[name].dtype == expected.dtype
        assert found[name].shape == expected.shape
        assert np.array_equal(found[name], expected)


def test_the_limits_are_those_of_a_large_forest() -> None:
    assert packed_arrays.MAX_BYTES == 512 * 2**20
    entry = npy(described("|u1", "1,"), b"x")
    many = [(f"{i}.npy", entry) for i in range(257)]
    assert len(unpacked(npz(*many[:256]))) == 256
    assert refused(npz(*many)) == "holds 257 arrays under 257 names"


def test_declared_sizes_are_added_before_memory_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = npy(described("|u1", f"{2**20},"), bytes(2**20))
    body = npz(("a.npy", entry), ("b.npy", entry), method=zipfile.ZIP_DEFLATED)
    monkeypatch.setattr(packed_arrays, "MAX_BYTES", 2 * len(entry))
    assert len(unpacked(body)) == 2
    monkeypatch.setattr(packed_arrays, "MAX_BYTES", 2 * len(entry) - 1)
    assert refused(body) == "declares 2 MiB, more than 2"


def test_a_file_shrank_to_a_sixty_fourth_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regular_file, "_ALWAYS_BYTES", 0)
    noise = np.random.default_rng(1).bytes(4000)
    ratios = []
    for zeros in range(300_000, 320_000, 500):
        entry = npy(described("|u1", f"{len(noise) + zeros},"), noise + bytes(zeros))
        body = npz(("a.npy", entry), method=zipfile.ZIP_DEFLATED)
        ratios.append(len(entry) / len(body))
        if ratios[-1] <= 64:
            assert len(unpacked(body)["a"]) == len(noise) + zeros
        else:
            assert refused(body).startswith("declares ")
    assert min(ratios) < 63.9
    assert max(ratios) > 64.1


def test_a_stream_is_as_long_as_it_declares_even_if_its_checksum_is_right() -> None:
    entry = npy(described("|u1", "100,"), bytes(100))
    body = bytearray(npz(("a.npy", entry[:-10]), method=zipfile.ZIP_DEFLATED))
    for at in (22, body.index(b"PK\1\2") + 24):  # uncompressed size, by local and central header
        assert struct.unpack_from("<I", body, at) == (len(entry) - 10,)
        struct.pack_into("<I", body, at, len(entry))
    assert refused(bytes(body)) == "'a.npy' ends after 90 of 100 bytes"


def test_a_name_stands_once() -> None:
    entry = npy(described("|u1", "1,"), b"x")
    with pytest.warns(UserWarning, match="Duplicate name"):
        body = npz(("a.npy", entry), ("a.npy", entry))
    assert refused(body) == "holds 2 arrays under 1 names"


def test_only_what_numpy_uses_is_unpacked() -> None:
    for method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        told = refused(npz(("a.npy", npy(described("|u1", "1,"), b"x")), method=method))
        assert told == "'a.npy' is compressed in a way that numpy never uses"


@pytest.mark.parametrize(
    ("header", "held", "declared"),
    [
        (described("<f8", "2,"), 15, 16),
        (described("<f8", "2,"), 17, 16),
        (described("<f4", "2, 3"), 20, 24),
        (described("<f8", ""), 0, 8),
        (described("<f8", "0, 5"), 8, 0),
    ],
)
def test_an_array_declares_the_bytes_that_it_holds(header: str, held: int, declared: int) -> None:
    told = refused(npz(("a.npy", npy(header, bytes(held)))))
    assert told == f"'a.npy' declares {declared} bytes and holds {held}"


@pytest.mark.parametrize(
    ("header", "start"),
    [
        (described("<f8", "1,"), b"\x93NUMPY\x02\x00"),
        (described("<f8", "1,"), b"\x93NUMPX\x01\x00"),
        (described("<U4", "1,"), START),
        (described("|O", "1,"), START),
        (described("<f8", "1" + "0" * 80), START),
        (described("<f8", "-1,"), START),
        (described("<f8", "1,") + "x", START),
        ("__import__('os')", START),
        ("", START),
    ],
)
def test_another_header_begins_no_array(header: str, start: bytes) -> None:
    told = refused(npz(("a.npy", npy(header, bytes(8), start))))
    assert told.endswith(" begins no array of numbers")


def test_what_is_no_archive_is_told_in_a_short_line() -> None:
    whole = npz(("a.npy", npy(described("<f8", "4,"), bytes(32))))
    at = whole.index(bytes(32))
    short = npy(described("<f8", "2,"), bytes(15))
    for body, told in (
        (b"", "File is not a zip file"),
        (whole[:at] + b"\1" + whole[at + 1 :], "Bad CRC-32 for file 'a.npy'"),
        (npz(("a.npy", npy("y" * 200))), f"{b'y' * 80!r} begins no array of numbers"),
        (npz(("a" * 300, short)), "'" + "a" * 199),
    ):
        assert refused(body) == told
