"""C compilers of the targets: found or not, and the flags that each needs."""

import shutil
from dataclasses import dataclass

from springpot.codegen.messages import short_repr
from springpot.host.native.compiler import find_compiler


@dataclass(frozen=True)
class Toolchain:
    """A compiler's command, its size tool, and the flags of one target."""

    compiler: tuple[str, ...]
    size: str
    flags: tuple[str, ...]
    __repr__ = short_repr


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
SOFT_DOUBLES = ("cortex-m4f", "rv32imafc")  # doubles run in software


def toolchain(target: str) -> Toolchain | None:
    """Return the target's toolchain, or None where it is not installed.

    Raises CompilerError for the host without any compiler.
    """
    if target == "host":
        size = shutil.which("size")
        return Toolchain(find_compiler(), size, ()) if size else None
    prefix, flags = _CROSS[target]
    compiler, size = shutil.which(prefix + "gcc"), shutil.which(prefix + "size")
    if compiler is None or size is None:
        return None
    return Toolchain((compiler,), size, flags)


def package_of(target: str) -> str:
    """System packages that hold the target's compiler, or this machine's size tool."""
    if target == "host":
        return "binutils"
    return "gcc-arm-none-eabi" if target.startswith("cortex") else "gcc-riscv64-unknown-elf"


def missing_tools(target: str) -> str:
    """What is missing to compile for the target and how to get it; nothing where all is there."""
    if toolchain(target) is not None:
        return ""
    install = f"`apt-get install {package_of(target)}`"
    if target == "host":
        return f"no `size` on PATH: {install}"
    return f"no compiler for {target}: {install}"
