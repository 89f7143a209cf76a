"""One reader under atheris, in a process of its own; fuzz.py starts it.

    harness.py NAME FOLDER CORPUS... [-options of libFuzzer]
    harness.py NAME FOLDER --replay FILE     reads one input as users would; the status says whether
                                             it was read or refused in one line

FOLDER/findings gets, for each place where a reader fails, the exception and the shortest input.
"""

import hashlib
import importlib
import logging
import os
import shutil
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

READERS = ("text", "mat", "scene")


def note_finding(folder: Path, content: bytes, error: BaseException) -> None:
    """Keep the shortest input of each place in the project's code that an exception comes from."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "/proof/fuzz/" not in frame.filename] or frames
    inner = next((f for f in reversed(ours) if "/springpot/" in f.filename), ours[-1])
    what = f"{type(error).__name__} at {Path(inner.filename).name}:{inner.lineno}"
    stem = folder / hashlib.sha256(what.encode()).hexdigest()[:12]
    kept = stem.with_suffix(".input")
    if kept.exists() and len(content) >= kept.stat().st_size:
        return
    folder.mkdir(parents=True, exist_ok=True)
    kept.write_bytes(content)
    message = " ".join(str(error).split())[:300]
    lines = "".join(traceback.format_exception(error))
    stem.with_suffix(".txt").write_text(f"{what}: {message}\n\n{lines}")


def main(name: str, folder: Path, arguments: list[str]) -> None:
    """Fuzz until libFuzzer's options say that it is enough, or read one input."""
    replay = arguments[0] == "--replay"
    if not replay:
        import atheris

        with atheris.instrument_imports(include=["springpot", "can", "zipfile", "tomllib"]):
            module = importlib.import_module(f"proof.fuzz.{name}_reader")
    else:
        module = importlib.import_module(f"proof.fuzz.{name}_reader")
    from proof.fuzz.reader import refused_in_one_line

    logging.disable()
    warnings.simplefilter("ignore")
    place = Path(
        tempfile.mkdtemp(prefix="fuzz-", dir="/dev/shm" if Path("/dev/shm").is_dir() else None)
    )
    reader = module.READER
    if replay:
        read = reader.as_users or reader.read
        refused_in_one_line(read, Path(arguments[1]).read_bytes(), place)
        shutil.rmtree(place)
        return

    sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115, notices of what was recovered

    def one_input(content: bytes) -> None:
        try:
            refused_in_one_line(reader.read, content, place)
        except Exception as error:
            note_finding(folder / "findings", content, error)

    atheris.Setup([sys.argv[0], *arguments], one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), sys.argv[3:])
