"""Whether the tests notice every change of the C that keeps the hand safe.

    python tests/proof/mutation/mutate_c.py [NAME ...]

Makes each single change of a file, builds the programs of tests/c that include it, float then
double, and prints what all of them let pass, less what equivalent.toml has a reason for. Status 1
where anything is left. Minutes: for a release, and where such a file was changed.
"""

import argparse
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from mutants_c import Mutant, mutants_of_c

ROOT = Path(__file__).resolve().parents[3]
FLAGS = ["-std=c11", "-ffp-contract=off", "-fno-math-errno", "-w", "-D_POSIX_C_SOURCE=200809L"]
REALS = ("float", "double")
TIMEOUT_S = 3  # the programs end in a few ms
PROGRAMS = {
    "sp_guard.h": ("test_guard", "test_patterns"),
    "sp_output.h": ("test_output", "test_patterns"),
    "sp_silence.h": ("test_silence",),
    "sp_contact.h": ("test_range",),
    "sp_range.h": ("test_range",),
}
EQUIVALENT = tomllib.loads(Path(__file__).with_name("equivalent.toml").read_text())


def includes(first: Path, real: str) -> list[str]:
    """Folders of headers, those in `first` before the runtime's own."""
    runtime = ROOT / "runtime_c"
    own = (f"include/{real}", "include", "src", "sim")
    return [f"-I{first}", *(f"-I{runtime / name}" for name in own), f"-I{ROOT / 'tests' / 'c'}"]


def machine_code(folder: Path, file: str, real: str) -> str | None:
    """Assembly of every function of a header, used or not; None if it does not compile."""
    keep = ["-O2", "-fkeep-inline-functions", "-fkeep-static-functions", "-xc"]
    header = folder / file if (folder / file).exists() else ROOT / "runtime_c" / "src" / file
    command = ["gcc", *FLAGS, *keep, *includes(folder, real), "-S", "-o-", str(header)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else None


def is_noticed(folder: Path, name: str, real: str) -> bool:
    """Whether a program of tests/c, with the headers in `folder`, fails or does not end."""
    program, source = folder / f"{name}-{real}", ROOT / "tests" / "c" / f"{name}.c"
    command = ["gcc", *FLAGS, *includes(folder, real), str(source), "-o", str(program), "-lm"]
    if subprocess.run(command, check=False, capture_output=True).returncode != 0:
        return True  # a member that only what includes the header needs
    try:
        ended = subprocess.run([program], capture_output=True, check=False, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return True
    return ended.returncode != 0


def survives(file: str, text: str, mutant: Mutant) -> bool:
    """Whether a change makes another program, which no test notices."""
    with tempfile.TemporaryDirectory(prefix="mutation-") as scratch:
        folder = Path(scratch)
        plain = [machine_code(folder, file, real) for real in REALS]
        (folder / file).write_text(mutant.apply(text))
        changed = [machine_code(folder, file, real) for real in REALS]
        if None in changed or changed == plain:
            return False
        return not noticed(folder, file)


def noticed(folder: Path, file: str) -> bool:
    return any(is_noticed(folder, name, real) for name in PROGRAMS[file] for real in REALS)


def main() -> int:
    """Try every change of the files that are named, or of all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", choices=[*PROGRAMS, []], metavar="NAME")
    left = 0
    for file in parser.parse_args().names or PROGRAMS:
        text = (ROOT / "runtime_c" / "src" / file).read_text()
        known = {tuple(one["change"]) for one in EQUIVALENT.get(file, ())}
        mutants = list(mutants_of_c(text))
        with tempfile.TemporaryDirectory(prefix="mutation-") as scratch:
            assert not noticed(Path(scratch), file), f"{file} fails its tests as it is"
        with ThreadPoolExecutor() as pool:
            found = list(pool.map(partial(survives, file, text), mutants))
        survivors = [one.lines(text) for one, alive in zip(mutants, found, strict=True) if alive]
        more = [change for change in survivors if change not in known]
        for before, after in more:
            print(f"{file}: {before}\n    -> {after}")
        equivalent = len(survivors) - len(more)
        print(f"{file}: {len(mutants)} changes, {equivalent} equivalent, {len(more)} unnoticed")
        left += len(more)
    return int(left > 0)


if __name__ == "__main__":
    sys.exit(main())
