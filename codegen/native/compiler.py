"""C compilers of this machine, libraries built on first use into a cache, and what it runs on."""

import hashlib
import importlib.util
import os
import platform
import shlex
import shutil
import stat
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path

from springpot.codegen.errors import SpringpotError
from springpot.codegen.files import atomic_write
from springpot.runtime_c.paths import flags


class CompilerError(SpringpotError):
    """A C compiler that refuses our sources."""


class NoCompilerError(CompilerError):
    """No C compiler at all."""


def cache_folder() -> Path:
    """Folder of built libraries: $XDG_CACHE_HOME/springpot, else ~/.cache/springpot."""
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    # The XDG specification: a relative path is invalid, and is ignored.
    return (base if base.is_absolute() else Path.home() / ".cache") / "springpot"


def packaged_compiler() -> tuple[str, ...]:
    """Return the command of the compiler that `springpot[cc]` brings, or nothing."""
    if importlib.util.find_spec("ziglang") is None:
        return ()
    return (sys.executable, "-P", "-m", "ziglang")  # -P: no module of the current folder


def compiler_reason() -> str:
    """Say why `find_compiler` takes the one that it takes."""
    if os.environ.get("CC", "").strip():
        return "CC names it"
    if (packaged := packaged_compiler()) and find_compiler() == (*packaged, "cc"):
        return "of springpot[cc]: there is no gcc, clang or cc on PATH, and CC is not set"
    return "the first of gcc, clang, cc on PATH; CC would name another"


@cache
def find_compiler() -> tuple[str, ...]:
    """Return the command that compiles.

    $CC, which may be several words; else gcc, clang or cc; else that of `springpot[cc]`. The
    first word is a path. Raises NoCompilerError with what to install where there is none.
    """
    asked = os.environ.get("CC", "").strip()
    if asked:
        try:
            words = [asked] if shutil.which(asked) else shlex.split(asked)
        except ValueError as error:
            raise NoCompilerError(f"CC={asked}: cannot be read ({error}): unset CC") from None
        program = shutil.which(words[0])
        if program is None:
            raise NoCompilerError(
                f"CC={asked}: no {words[0]} on PATH: unset CC, or install what it names"
            )
        return (program, *words[1:])
    for name in ("gcc", "clang", "cc"):
        if program := shutil.which(name):
            return (program,)
    if packaged := packaged_compiler():
        return (*packaged, "cc")
    raise NoCompilerError(
        "no C compiler on PATH (looked for gcc, clang, cc): install one, for example with "
        "`apt-get install gcc` or `pip install 'springpot[cc]'`, or set CC"
    )


@cache
def compiler_version(compiler: tuple[str, ...]) -> str:
    """First line of `compiler --version`."""
    result = subprocess.run([*compiler, "--version"], capture_output=True, text=True, check=False)
    lines = (result.stdout or result.stderr).splitlines()
    return lines[0].strip() if lines else f"{' '.join(compiler)}, of no known version"


def run_compiler(
    arguments: Sequence[str], what: str = "the sources", compiler: Sequence[str] = ()
) -> None:
    """Run a compiler, by default this machine's.

    Raises CompilerError with its first error line where it refuses `what`.
    """
    compiler = compiler or find_compiler()
    result = subprocess.run([*compiler, *arguments], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        # The linker says "error" only of its own end.
        marks = ("error", "multiple definition", "overflowed by")
        lines = [line for line in result.stderr.splitlines() if any(word in line for word in marks)]
        complaint = lines[0] if lines else result.stderr.strip()[-300:]
        raise CompilerError(f"{' '.join(compiler)} refused {what}: {complaint}")


def shared_library(
    sources: Sequence[Path], include: Sequence[Path], extra_flags: Sequence[str] = ()
) -> Path:
    """Build `sources` into one shared library, or return the one built before.

    The key covers every source, every header in the `include` folders, compiler, flags and
    machine. The library is written aside and renamed into place: concurrent builds are safe.
    """
    build_flags = [*flags("SP_CFLAGS"), *flags("SP_SHARED"), *extra_flags]
    if sys.platform == "win32":  # or a library of MSYS2's gcc needs DLLs that lie beside gcc
        build_flags.append("-static")
    if sys.platform == "darwin":  # whose libraries keep to themselves; Apple's ld refuses the word
        build_flags.remove("-Wl,-Bsymbolic")
    library = cache_folder() / f"{_key(sources, include, build_flags)}.so"
    try:
        library.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        for path in (library.parent, library):
            _require_own(path)
        if library.exists() and library.stat().st_size:  # one that a full disk cut is built again
            return library
    except OSError as error:
        raise CompilerError(
            f"{library.parent}: {error.strerror}: set XDG_CACHE_HOME to a folder that you can write"
        ) from None
    folders = [f"-I{folder}" for folder in include]
    with (
        _unless_it_exists(library),
        atomic_write(library, durable=True) as built,  # a part of one would crash the process
    ):
        run_compiler([*build_flags, *folders, *map(str, sources), "-o", str(built), "-lm"])
        if not built.exists():
            raise CompilerError(
                f"{' '.join(find_compiler())} wrote no library: set CC to a C compiler"
            )
        built.chmod(0o700)  # whatever the umask: see _require_own
    return library


@contextmanager
def _unless_it_exists(library: Path) -> Iterator[None]:
    """Take the library of a build at the same time: Windows replaces none that is loaded."""
    try:
        yield
    except PermissionError:
        if not library.exists():
            raise


def _require_own(path: Path) -> None:
    """Refuse a cached library that others can write, or wrote: it would run in this process."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return
    if not hasattr(os, "geteuid"):  # Windows keeps a user's folders to the user
        return
    if status.st_uid != os.geteuid():
        reason = f"belongs to user {status.st_uid}"
    elif status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        reason = "can be written by others"
    else:
        return
    raise CompilerError(
        f"{path}: {reason}, and what lies there would run as you: set XDG_CACHE_HOME to a folder "
        f"of your own, or `chmod go-w` and remove what is not yours"
    )


def _key(sources: Sequence[Path], include: Sequence[Path], build_flags: Sequence[str]) -> str:
    """Return a library's name in the cache: a hash of sources, compiler, flags and machine."""
    headers = [header for folder in include for header in sorted(folder.glob("*.h"))]
    digest = hashlib.sha256()
    for file in [*sources, *headers]:
        digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    metadata = [
        compiler_version(find_compiler()),
        *find_compiler(),
        *build_flags,
        platform.machine(),
        platform.system(),
    ]
    digest.update("\0".join(metadata).encode())
    return digest.hexdigest()[:32]


def machine_metadata() -> dict[str, str]:
    """Processor, system, compiler, flags, versions: name -> text."""
    try:
        compiler = compiler_version(find_compiler())
    except CompilerError:
        compiler = "none"
    return {
        "processor": f"{_processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "compiler": compiler,
        "flags": " ".join(flags("SP_CFLAGS")),
        "Python": platform.python_version(),
        "springpot": version("springpot"),
        "numpy": version("numpy"),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
