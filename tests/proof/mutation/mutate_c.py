"""Whether the tests notice every change of the C that keeps the hand safe.

python tests/proof/mutation/mutate_c.py OUT.json [--only NAME] [--workers N]

The programs of tests/c alone, float then double: they are exact, end in milliseconds and depend on
no clock."""

import subprocess
import sys
import tempfile
from pathlib import Path

from killing import ROOT, SURVIVED, UNCHANGED, parse_options, try_all
from mutants_c import mutants_of_c
from survivors import write_result

TIMEOUT_S = 3  # they end in a few ms
FLAGS = ["-std=c11", "-ffp-contract=off", "-fno-math-errno", "-w"]
REALS = ("float", "double")


_LOOP = ("test_loop", "test_loop_end", "test_loop_device", "test_loop_periods")
# Programs of tests/c that may catch the mutants of a file.
PROGRAMS = {
    "runtime_c/src/sp_guard.h": ("test_guard", "test_patterns"),
    "runtime_c/src/sp_output.h": ("test_output", "test_patterns"),
    "runtime_c/src/sp_silence.h": ("test_silence",),
    "runtime_c/src/sp_contact.h": ("test_range",),
    "runtime_c/src/sp_range.h": ("test_range",),
    "runtime_c/port/wire/sp_wire.c": ("test_wire",),
    "runtime_c/port/posix/sp_loop_tick.c": _LOOP,
    "runtime_c/port/posix/sp_loop.c": _LOOP,
    "runtime_c/port/posix/sp_loop_sample.c": _LOOP,
}


def _includes(copy: Path, real: str) -> list[str]:
    runtime = copy / "runtime_c"
    own = (f"include/{real}", "include", "src", "sim", "port/posix", "port/wire")
    return [*(f"-I{runtime / folder}" for folder in own), f"-I{copy / 'tests' / 'c'}"]


def machine_code(copy: Path, file: str, real: str) -> str | None:
    """The assembly of every function of a file, used or not; None where it does not compile."""
    keep = ["-fkeep-inline-functions", "-fkeep-static-functions", "-pthread", "-xc"]
    result = subprocess.run(
        ["gcc", *FLAGS, "-O2", *keep, *_includes(copy, real), "-S", "-o-", str(copy / file)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    return result.stdout if result.returncode == 0 else None


def program_fails(copy: Path, name: str, real: str) -> bool:
    """Whether a program of tests/c, built of a copy of the checkout, fails or does not end."""
    source = copy / "tests" / "c" / f"{name}.c"
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        program = Path(folder) / name
        command = ["gcc", *FLAGS, "-O0", "-D_POSIX_C_SOURCE=200809L", *_includes(copy, real)]
        subprocess.run([*command, str(source), "-o", str(program), "-lm"], check=True)
        try:
            ended = subprocess.run(
                [program], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False,
                timeout=TIMEOUT_S,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return True
    return ended.returncode != 0


def main() -> int:
    options = parse_options(PROGRAMS)
    files = options.files
    original = {(file, real): machine_code(ROOT, file, real) for file in files for real in REALS}
    for program in sorted({name for file in files for name in PROGRAMS[file]}):
        if any(program_fails(ROOT, program, real) for real in REALS):
            print(f"tests/c/{program}.c fails as it is: mend that first", file=sys.stderr)
            return 2

    def is_another_program(copy: Path, file: str) -> bool:
        for real in REALS:
            code = machine_code(copy, file, real)
            if code is None or code != original[file, real]:
                return code is not None
        return False

    def attempt(copy: Path, file: str, text: str) -> str:
        (copy / file).write_text(text)
        if not is_another_program(copy, file):
            return UNCHANGED
        for real in REALS:
            for program in PROGRAMS[file]:
                if program_fails(copy, program, real):
                    return f"tests/c/{program}.c ({real})"
        return SURVIVED

    tried = try_all(
        ROOT / "build" / "mutation" / "c.jsonl", files, mutants_of_c, attempt, options.workers
    )
    command = "python tests/proof/mutation/mutate_c.py OUT.json"
    return int(
        write_result(options.out, "Mutation of the C that ends in a force", command, tried) > 0
    )


if __name__ == "__main__":
    sys.exit(main())
