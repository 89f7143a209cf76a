"""C as one WebAssembly module without imports: what a page or node runs."""

import re
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from springpot.codegen.errors import UsageError
from springpot.host.native.compiler import CompilerError, first_error
from springpot.host.native.scene_library import scene_prefix
from springpot.host.native.toolchain import missing_tools, toolchain
from springpot.runtime_c.paths import flags

# Below the data, so that a stack that overflows traps; room for a state, which the self-test keeps
# there. It is memory that the module asks for, no byte of it.
_STACK_BYTES = 1 << 20
_LINK = ("--no-entry", "--strip-all", "--stack-first", "-z", f"stack-size={_STACK_BYTES}")
HEAP = "__heap_base"  # where memory that nothing of the module uses begins


def scene_module(
    folder: Path,
    sources: Sequence[Path] = (),
    include: Sequence[Path] = (),
    exports: Sequence[str] = (),
) -> bytes:
    """An emitted folder's C, for whatever target, and further C beside it, as one module.

    It exports every function of the scene's header and `exports`: see `wasm_module`.
    """
    scene = folder / f"{scene_prefix(folder)}.c"
    functions = scene_functions(folder)
    return wasm_module([scene, *sources], [folder, *include], [*functions, *exports])


def scene_functions(folder: Path) -> list[str]:
    """Names of the C functions that an emitted folder's header declares."""
    prefix = scene_prefix(folder)
    header = (folder / f"{prefix}.h").read_text(encoding="utf-8")
    return re.findall(rf"^\w[\w *]*?\b({prefix}_\w+)\(", header, re.MULTILINE)


def wasm_module(sources: Sequence[Path], include: Sequence[Path], exports: Sequence[str]) -> bytes:
    """Compile and link `sources` into a module that exports `exports`, `memory` and HEAP.

    Functions that no export reaches are left out. Raises UsageError without compiler or linker,
    CompilerError where they refuse: a function that is nowhere defined is named.
    """
    tools = toolchain("wasm32")
    if tools is None:
        raise UsageError(missing_tools("wasm32"))
    compile_ = [*tools.compiler, *flags("SP_CFLAGS"), *tools.flags]
    folders = [f"-I{folder}" for folder in include]
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        built = Path(scratch) / "module.wasm"
        objects = [Path(scratch) / f"{number}.o" for number in range(len(sources))]
        for source, unlinked in zip(sources, objects, strict=True):
            _run([*compile_, *folders, "-c", str(source), "-o", str(unlinked)])
        kept = [f"--export={name}" for name in (*exports, HEAP)]
        _run([*tools.linker, *_LINK, *kept, *map(str, objects), "-o", str(built)])
        return built.read_bytes()


def _run(command: Sequence[str]) -> None:
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise CompilerError(f"{command[0]} made no wasm module: {first_error(result.stderr)}")
