"""Readers of files and bytes under a fuzzer: atheris for Python, libFuzzer for the C of the wire.

    python tests/proof/fuzz/fuzz.py TARGET [OPTION OF LIBFUZZER ...]

TARGET is scene, text or wire. It ends with status 1 or more at the first input that leads to
anything but a result or one line for users, and keeps that input. `make soak` gives each an hour.
"""

import argparse
import logging
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests"))
WORK = ROOT / "build" / "fuzz"
Reader = Callable[[Path], object]
SCENE = b'schema = 1\nname = "a"\nmodel = "m"\n'
ROWS = b"time_s,position_mm,force_N\n0.00,0,0\n0.01,0.1,0.3\n0.02,0.3,0.9\n0.03,0.2,0.6\n"
SEEDS = {
    "scene": [
        SCENE + b'[coupling]\nmode = "proxy"\n[guard]\noutside = "hold"\nmax_force_n = 12.0\n',
        SCENE + b'runtime = {rate_hz = 2000, number = "float64", prefix = "eco"}\n',
    ],
    "text": [
        ROWS,
        b"Rig;7\n" + ROWS.replace(b",", b";").replace(b".", b","),
        ROWS.replace(b",", b"\t").decode().encode("utf-16"),
        b'"time_s","position_mm","force_N","note"\n0,0,0,"a, b"\n0.1,1,1,""\n0.2,2,2,c\n',
    ],
}


def scene_reader() -> Reader:
    """Read a scene, and plan the emission of a small model in it."""
    from support.small import small_model

    from springpot.codegen.errors import SpringpotError, UsageError
    from springpot.codegen.make_plan import make_plan
    from springpot.host.emission.scene_file import read_scene

    def read(file: Path) -> None:
        found = read_scene(file)
        try:
            make_plan(small_model(), found)
        except SpringpotError as error:  # names the key, not the file
            raise UsageError(f"{file}: {error}") from None

    return read


def text_reader() -> Reader:
    from springpot.trainer.recordings.formats.importing import import_file

    return import_file


READERS = {"scene": scene_reader, "text": text_reader}


def require_line(read: Reader, file: Path) -> None:
    """Read a file; what is refused is told in one printable line that names it."""
    from springpot.codegen.errors import SpringpotError

    try:
        read(file)
    except SpringpotError as error:
        message = str(error)
        assert message.isprintable() and len(message) <= 4000, message[:200]
        assert str(file) in message, f"does not name the file: {message[:200]}"


def built_wire() -> Path:
    """The C target, with both sanitizers."""
    from springpot.codegen.native.c_library import declarations

    runtime = ROOT / "runtime_c"
    port = runtime / "port"
    links = [port / "posix" / f"sp_link_{kind}.c" for kind in ("serial", "odrive", "bytes")]
    # What the links declare in their own files.
    (WORK / "declared_links.h").write_text(f'#include "sp_link.h"\n{declarations(links)}\n')
    sources = [Path(__file__).with_name("fuzz_wire_bytes.c"), port / "wire" / "sp_wire.c", *links]
    folders = [runtime / "include", runtime / "include" / "float", runtime / "sim",
               port / "wire", port / "posix", WORK]  # fmt: skip
    flags = ["-g", "-O1", "-std=c11", "-D_GNU_SOURCE", "-fno-sanitize-recover=all",
             "-fsanitize=fuzzer,address,undefined"]  # fmt: skip
    program = WORK / "fuzz_wire_bytes"
    words = [*flags, *(f"-I{folder}" for folder in folders), *sources, "-lm", "-o", program]
    subprocess.run(["clang", *map(str, words)], check=True)
    return program


def main(target: str, options: list[str]) -> int:
    corpus = WORK / target
    corpus.mkdir(parents=True, exist_ok=True)
    if target == "wire":
        return subprocess.run([built_wire(), *options, corpus], check=False).returncode
    import atheris

    with atheris.instrument_imports(include=["springpot", "tomllib"]):
        read = READERS[target]()
    logging.disable()
    warnings.simplefilter("ignore")
    file = Path(tempfile.mkdtemp(prefix="fuzz-")) / "a.csv"
    for number, seed in enumerate(SEEDS[target]):
        (corpus / f"seed-{number}").write_bytes(seed)

    def one_input(content: bytes) -> None:
        file.write_bytes(content)
        require_line(read, file)

    atheris.Setup([sys.argv[0], *options, str(corpus)], one_input)
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("target", choices=[*READERS, "wire"])
    asked, libfuzzer = parser.parse_known_args()
    sys.exit(main(asked.target, libfuzzer))
