"""A PATH with and without cross compilers: what they print, by the compiler of this machine."""

import os
from pathlib import Path

_CROSS = ("arm-none-eabi-", "riscv64-unknown-elf-", "wasm-ld", "qemu-system-", "node")
_GCC = """#!/bin/sh
# The target's flags mean nothing to the compiler of this machine.
for flag do
    shift
    case $flag in
        -mthumb | -mfloat-abi=* | -mcpu=* | -mfpu=*) ;;
        *) set -- "$@" "$flag" ;;
    esac
done
exec gcc "$@"
"""


def path_without(folder: Path) -> str:
    """A PATH in `folder` that holds this machine's tools, and no cross compiler or emulator."""
    folder.mkdir()
    for place in filter(Path.is_dir, map(Path, os.environ["PATH"].split(os.pathsep))):
        for tool in place.iterdir():
            link = folder / tool.name
            if not tool.name.startswith(_CROSS) and not link.is_symlink():
                link.symlink_to(tool)
    return str(folder)


def path_with(folder: Path) -> str:
    """The PATH of now behind an arm-none-eabi-gcc whose sizes are those of this machine's code."""
    folder.mkdir()
    for name, text in (("gcc", _GCC), ("size", '#!/bin/sh\nexec size "$@"\n')):
        tool = folder / f"arm-none-eabi-{name}"
        tool.write_text(text)
        tool.chmod(0o755)
    return f"{folder}{os.pathsep}{os.environ['PATH']}"
