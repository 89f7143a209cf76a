"""Source archive and wheel of a commit into a folder: the same commit, the same bytes.

Everything is built twice, from an archive of the commit and never from the working tree; other
bytes the second time are an error. python .ci/dist.py [FOLDER]
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_BUILD = "import sys; from setuptools import build_meta; build_meta.{}(sys.argv[1])"


def git(*arguments: str | Path) -> str:
    """Return what git prints in the checkout."""
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()


def build(hook: str, source: Path, out: Path) -> None:
    """Call a hook of setuptools in an unpacked source; times in its files are the commit's."""
    environment = {**os.environ, "SOURCE_DATE_EPOCH": git("log", "-1", "--format=%ct")}
    done = subprocess.run(
        [sys.executable, "-c", _BUILD.format(hook), out],
        cwd=source, capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(f"dist: {hook} failed\n{done.stdout}{done.stderr}")


def unpacked(archive: Path, into: Path) -> Path:
    """Unpack an archive with one folder; return that."""
    with tarfile.open(archive) as opened:
        opened.extractall(into, filter="data")
    return next(into.iterdir())


def distributions(scratch: Path, out: Path) -> list[Path]:
    """Build the source archive, and of it the wheel."""
    plain = scratch / "plain.tar"
    git("archive", "--format=tar", "--prefix=springpot/", "-o", plain, "HEAD")
    metadata = scratch / "metadata"
    metadata.mkdir()
    build("prepare_metadata_for_build_wheel", unpacked(plain, scratch / "tree"), metadata)
    (facts,) = metadata.glob("*.dist-info/METADATA")
    name = facts.parent.name.removesuffix(".dist-info")
    added = f"--add-virtual-file={name}/PKG-INFO:{facts.read_text()}"
    source = out / f"{name}.tar.gz"
    git("archive", "--format=tar.gz", f"--prefix={name}/", added, "-o", source, "HEAD")
    build("build_wheel", unpacked(source, scratch / "source"), out)
    (wheel,) = out.glob("*.whl")
    return [source, wheel]


def checksum(file: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def main() -> int:
    """Build, build again, compare, keep the first."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", default=Path("dist"))
    folder = parser.parse_args().folder.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        sums = []
        for name in ("one", "two"):
            work, out = Path(scratch) / name, Path(scratch) / f"out-{name}"
            work.mkdir()
            out.mkdir()
            built = distributions(work, out)
            sums.append({file.name: checksum(file) for file in built})
        if sums[0] != sums[1]:
            print(f"dist: two builds differ: {sums}", file=sys.stderr)
            return 1
        folder.mkdir(exist_ok=True, parents=True)
        for old in (*folder.glob("*.whl"), *folder.glob("*.tar.gz")):
            old.unlink()
        for file in (Path(scratch) / "out-one").iterdir():
            shutil.copyfile(file, folder / file.name)
            print(f"{sums[0][file.name]}  {folder / file.name}  {file.stat().st_size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
