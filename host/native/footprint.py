"""Flash and stack of a scene's C on its target, from the target's own compiler."""

import re
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from springpot.host.native.compiler import CompilerError
from springpot.host.native.toolchain import Toolchain
from springpot.runtime_c.paths import flags

_FLASH_SIZES = re.compile(r"^\.(?:text|rodata|data)\S*\s+(\d+)", re.M)
_NODE = re.compile(r'^node: \{ title: "([^"]+)" label: "[^"]*?(?:\\n(\d+) bytes \((\w+)[^"]*)?"')
_NO_SELFTEST = "-DSP_NO_SELFTEST"  # where it is in the same file
_EDGE = re.compile(r'^edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')


@dataclass(frozen=True)
class Footprint:
    """Bytes of the scene's translation unit; stack_bytes is None where unreported.

    flash_bytes: code, constants and initialised data.
    """

    flash_bytes: int
    stack_bytes: int | None


def measure_footprint(folder: Path, source: str, tools: Toolchain) -> Footprint:
    """Compile folder/source for the target and read the sizes. Raises CompilerError."""
    with tempfile.TemporaryDirectory() as scratch:
        built = Path(scratch) / "scene.o"
        command = [
            *tools.compiler, *flags("SP_CFLAGS"), *tools.flags, _NO_SELFTEST,
            "-fcallgraph-info=su", "-c",
            str(folder / source), "-o", str(built),
        ]  # fmt: skip
        graph = True
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:  # clang has no call graph
            command.remove("-fcallgraph-info=su")
            graph = False
            result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise CompilerError(
                f"{tools.compiler[0]} refused {source}: {result.stderr.strip()[:300]}"
            )
        sizes = subprocess.run(
            [tools.size, "-A", "-d", str(built)], capture_output=True, text=True, check=True
        ).stdout
        info = next(Path(scratch).glob("*.ci"), None) if graph else None
        return Footprint(
            flash_bytes=sum(map(int, _FLASH_SIZES.findall(sizes))),
            stack_bytes=deepest_stack(info.read_text()) if info else None,
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
