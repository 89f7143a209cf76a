"""An emitted scene and a hand that presses it, as one WebAssembly module; and its check in node."""

import hashlib
import re
import shutil
import subprocess
import tempfile
from importlib.resources import as_file, files
from pathlib import Path

from springpot.codegen.emit.golden import differentiate, golden_positions
from springpot.codegen.errors import MismatchError, SpringpotError, UsageError
from springpot.codegen.native.compiler import packaged_compiler, run_compiler
from springpot.codegen.plan import Plan
from springpot.codegen.stages.expressions import require_no_libm
from springpot.host.native.replay import Replay
from springpot.host.native.scene_library import SceneLibrary, write_port
from springpot.runtime_c.paths import PORT_BROWSER, PORT_WASM, SIM, flags

# No C library; a stack with room for the self-test's state, below the data: overflow traps.
_COMPILE = ("-msimd128", "-mbulk-memory", "-nostdlibinc", "-isystem", str(PORT_WASM))
_LINK = ("--no-entry", "--strip-all", "--stack-first", "-z", f"stack-size={1 << 20}")


def page_module(folder: Path, plan: Plan) -> bytes:
    """Compile and link the C of an emitted folder with the page's port.

    Raises UsageError without compiler or linker, CompilerError where they refuse.
    """
    require_no_libm(plan.model.regressor, "the page")
    prefix = plan.scene.runtime.prefix
    compiler, linker = _tools()
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        place = Path(scratch)
        write_port(folder, plan.real, PORT_BROWSER.glob("*.[ch]"), place)
        names = [f"{prefix}_{name}" for name in ("selftest", "state_size", "init", "run")]
        names += re.findall(
            r"\b(sp_page_\w+)[(\[]", (place / "sp_page.h").read_text(encoding="utf-8")
        )
        exports = [f"--export={name}" for name in (*names, "__heap_base")]
        include = [f"-I{path}" for path in (place, folder, SIM)]
        options = [*flags("SP_CFLAGS"), *_COMPILE, *include, "-c"]
        objects = []
        for source in (folder / f"{prefix}.c", place / "sp_page.c"):
            objects.append(str(place / f"{source.stem}.o"))
            run_compiler([*options, str(source), "-o", objects[-1]], source.name, compiler)
        module = place / "module.wasm"
        run_compiler([*_LINK, *exports, *objects, "-o", str(module)], "the page's module", linker)
        return module.read_bytes()


def node_force_hash(folder: Path, plan: Plan, module: bytes) -> str | None:
    """Run the module in node: SHA-256 of its forces of the golden motion; None without node.

    Raises MismatchError where the self-test fails, or a force has other bits than this machine's.
    """
    node = shutil.which("node")
    if node is None:
        return None
    position = golden_positions(plan).astype(plan.dtype)
    velocity = differentiate(position, plan.dt_s).astype(plan.dtype)
    script = files("springpot.host.pages") / "templates" / "check.mjs"
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch, as_file(script) as program:
        file = Path(scratch) / "module.wasm"
        file.write_bytes(module)
        command = [node, str(program), str(file), plan.scene.runtime.prefix, position.dtype.name]
        given = position.tobytes() + velocity.tobytes()
        done = subprocess.run(command, input=given, capture_output=True, check=False)
    if done.returncode != 0:
        raise SpringpotError(f"node could not run the page's module: {done.stderr[-300:].decode()}")
    selftest, force_hash = int.from_bytes(done.stdout[:4], "little"), done.stdout[4:]
    if selftest or force_hash != Replay(SceneLibrary(folder)).run(position, velocity)[0].tobytes():
        raise MismatchError(
            f"{folder}: the page's C gives other forces in node than this machine's (self-test "
            f"{selftest}): report clang, or the compiler of springpot[cc], and node"
        )
    return hashlib.sha256(force_hash).hexdigest()


def _tools() -> tuple[list[str], list[str]]:
    """Return the commands of compiler and linker. Raises UsageError where there are none."""
    clang, linker = shutil.which("clang"), shutil.which("wasm-ld")
    if clang and linker:
        return [clang, "--target=wasm32"], [linker]
    packaged = packaged_compiler()
    if not packaged:
        raise UsageError(
            "no compiler for WebAssembly: `apt-get install clang lld` or "
            "`pip install 'springpot[cc]'`"
        )
    return [*packaged, "cc", "--target=wasm32-freestanding"], [*packaged, "wasm-ld"]
