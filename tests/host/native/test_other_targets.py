"""Every stored model, coupled, for other processors, compilers and levels: it runs, same forces."""

import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.c import golden_forces
from support.small import scene

from springpot.codegen.emit.files import emit_files
from springpot.codegen.make_plan import make_plan
from springpot.runtime_c.paths import flags

pytestmark = pytest.mark.slow

INFO = Path("/proc/cpuinfo")
CPU = set(INFO.read_text().split()) if INFO.exists() else set()
AVX512 = {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}
TARGETS = {
    "avx512": ("gcc", "-march=x86-64-v4"),
    "this processor": ("gcc", "-march=native"),
    "32 bits": ("gcc", "-m32", "-malign-double", "-msse2", "-mfpmath=sse"),
    "not optimised": ("gcc", "-O0"),
    "optimised most": ("gcc", "-O3"),
    "clang": ("clang",),
    "clang, not optimised": ("clang", "-O0"),
    "clang, optimised most": ("clang", "-O3"),
    "clang, avx512": ("clang", "-march=x86-64-v4"),
}
# Vectors and their widths concern single precision; of doubles, what orders and rounds sums.
DOUBLES = ("32 bits", "not optimised", "optimised most", "clang")
MOTION_M = golden_forces.motion_m()[:2000]


def built(sources: list[Path], out: Path, compiler: str, *options: str) -> Path:
    command = [compiler, *flags("SP_CFLAGS"), *options, *map(str, sources), "-o", str(out)]
    command.append("-lm")  # a square root is a call where nothing is optimised
    subprocess.run(command, check=True, capture_output=True)
    return out


def run(program: Path) -> str:
    """Its forces as text; it runs the self-test first, and ends with 1 where that fails."""
    given = "\n".join(repr(float(x)) for x in MOTION_M[np.isfinite(MOTION_M)])
    done = subprocess.run([program], input=given, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@cache
def missing(target: str) -> str:
    """Why this machine cannot run that; empty where it can."""
    compiler, *options = TARGETS[target]
    if shutil.which(compiler) is None:
        return f"no {compiler} here"
    if "avx512" in target and not AVX512 <= CPU:
        return "this processor has no AVX-512"
    probe = subprocess.run([compiler, *options, "-xc", "-", "-o", "/dev/null"], text=True,
                           input="#include <math.h>\nint main(void) { return 0; }\n",
                           capture_output=True, check=False)  # fmt: skip
    return f"{compiler} {' '.join(options)} does not link here" if probe.returncode else ""


@pytest.mark.few(0, 20)
@pytest.mark.parametrize("name", golden_forces.models())
@pytest.mark.parametrize(("number", "mode"), [("float32", "proxy"), ("float64", "tool")])
@pytest.mark.parametrize("turn", range(3))
def test_the_same_forces_for_other_targets(
    tmp_path: Path, name: str, number: str, mode: str, turn: int
) -> None:
    """A third of the targets in each turn, with each model another one."""
    plan = make_plan(golden_forces.model(name), scene(number, mode), accept_unsafe=True)
    for file, text in emit_files(plan).items():
        (tmp_path / file).write_text(text)
    sources = sorted(tmp_path.glob("*.c"))
    wanted = run(built(sources, tmp_path / "plain", "gcc"))
    assert len(set(wanted.splitlines())) > 300
    first = golden_forces.models().index(name) + turn
    for target, (compiler, *options) in [*TARGETS.items()][first % 3 :: 3]:
        if not missing(target) and (number == "float32" or target in DOUBLES):
            assert run(built(sources, tmp_path / "other", compiler, *options)) == wanted, target
