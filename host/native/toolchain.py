"""C compilers of the targets, and the flash and stack of a scene's C from them."""

import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.messages import short_repr
from springpot.codegen.native.compiler import (
    CompilerError,
    NoCompilerError,
    find_compiler,
    run_compiler,
)
from springpot.host.native.scene_library import scene_prefix
from springpot.runtime_c.paths import flags

_ARM = ("-mthumb", "-mfloat-abi=hard")
_CROSS: dict[str, tuple[str, tuple[str, ...]]] = {
    "cortex-m4f": ("arm-none-eabi-", (*_ARM, "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16")),
    "cortex-m7": ("arm-none-eabi-", (*_ARM, "-mcpu=cortex-m7", "-mfpu=fpv5-d16")),
    "rv32imafc": (
        "riscv64-unknown-elf-",
        (
            "-march=rv32imafc",
            "-misa-spec=2.2",  # F and the counters without naming zicsr: the library's own choice
            "-mabi=ilp32f",
            "-mcmodel=medany",
            "-mno-relax",
            "--specs=picolibc.specs",
        ),
    ),
}
# Programs for boards: the package that has each, and what it is for.
PROGRAMS = {
    "arm-none-eabi-gcc": ("gcc-arm-none-eabi", "C for Cortex-M boards"),
    "riscv64-unknown-elf-gcc": ("gcc-riscv64-unknown-elf", "C for RISC-V boards"),
    "qemu-system-arm": ("qemu-system-arm", "boards without hardware"),
    "qemu-system-riscv32": ("qemu-system-misc", "boards without hardware"),
}
SOFT_DOUBLES = ("cortex-m4f", "rv32imafc")  # doubles run in software
_FLASH_SIZES = re.compile(r"^\.(?:text|rodata|data)\S*\s+(\d+)", re.M)
_NODE = re.compile(r'^node: \{ title: "([^"]+)" label: "[^"]*?(?:\\n(\d+) bytes \((\w+)[^"]*)?"')
_NO_SELFTEST = "-DSP_NO_SELFTEST"  # where it is in the same file
_EDGE = re.compile(r'^edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')


@dataclass(frozen=True)
class Toolchain:
    """A compiler's command, its size tool, and the flags of one target."""

    compiler: tuple[str, ...]
    size: str
    flags: tuple[str, ...]
    __repr__ = short_repr


def toolchain(target: str) -> Toolchain | None:
    """Return the target's toolchain, or None where it is not installed.

    Raises CompilerError for the host without any compiler.
    """
    if target == "host":
        size = None if sys.platform == "darwin" else shutil.which("size")  # Apple's has other words
        return Toolchain(find_compiler(), size, ()) if size else None
    prefix, flags = _CROSS[target]
    compiler, size = shutil.which(prefix + "gcc"), shutil.which(prefix + "size")
    if compiler is None or size is None:
        return None
    return Toolchain((compiler,), size, flags)


def missing_tools(target: str) -> str:
    """List what is missing to compile for the target, and how to get it."""
    if toolchain(target) is not None:
        return ""
    if target == "host":
        return "no `size` on PATH: `apt-get install binutils`"
    package, _ = PROGRAMS[f"{_CROSS[target][0]}gcc"]
    return f"no compiler for {target}: `apt-get install {package}`"


@dataclass(frozen=True)
class Footprint:
    """Bytes of the scene's translation unit; stack_bytes is None where unreported.

    flash_bytes: code, constants and initialised data.
    """

    flash_bytes: int
    stack_bytes: int | None


def measure_footprint(folder: Path, target: str, selftest: bool = False) -> Footprint:
    """Compile an emitted folder's C for the target, without its self-test, and read the sizes.

    selftest: with it.

    Raises NoCompilerError with what to install, CompilerError where the compiler refuses.
    """
    tools, source = toolchain(target), f"{scene_prefix(folder)}.c"
    if tools is None:
        raise NoCompilerError(missing_tools(target))
    with tempfile.TemporaryDirectory() as scratch:
        built = Path(scratch) / "scene.o"
        arguments = [*flags("SP_CFLAGS"), *tools.flags, *([] if selftest else [_NO_SELFTEST]),
                     "-c", str(folder / source),
                     "-o", str(built)]  # fmt: skip
        try:
            run_compiler([*arguments, "-fcallgraph-info=su"], source, tools.compiler)
        except CompilerError:  # clang has no call graph
            run_compiler(arguments, source, tools.compiler)
        sizes = subprocess.run(
            [tools.size, "-A", "-d", str(built)], capture_output=True, text=True, check=True
        ).stdout
        info = next(Path(scratch).glob("*.ci"), None)
        return Footprint(
            flash_bytes=sum(map(int, _FLASH_SIZES.findall(sizes))),
            stack_bytes=deepest_stack(info.read_text(encoding="utf-8")) if info else None,
        )


def deepest_stack(call_graph: str) -> int | None:
    """Maximum sum of frames along any path of a -fcallgraph-info=su graph, bytes.

    None where a frame is unbounded or the graph has a cycle. Functions from outside (memcpy,
    memset) count as 0: they are leaves that keep to registers or a few words.
    """
    frames: dict[str, int] = {}
    calls: dict[str, set[str]] = {}
    for line in call_graph.splitlines():
        if node := _NODE.match(line):
            if node[3] == "dynamic":
                return None
            frames[node[1]] = int(node[2] or 0)
        elif edge := _EDGE.match(line):
            calls.setdefault(edge[1], set()).add(edge[2])

    def depth(name: str, above: tuple[str, ...]) -> int:
        if name in above:
            raise RecursionError(name)
        below = (depth(callee, (*above, name)) for callee in calls.get(name, ()))
        return frames.get(name, 0) + max(below, default=0)

    try:
        return max((depth(name, ()) for name in frames), default=0)
    except RecursionError:
        return None
