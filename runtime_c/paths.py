"""Where the C sources lie, and the flags they are built with."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent
INCLUDE = ROOT / "include"
SOURCE = ROOT / "src"
SIM = ROOT / "sim"
PORT_TESTBENCH = ROOT / "port" / "testbench"
PORT_FIT = ROOT / "port" / "fit"
PORT_POSIX = ROOT / "port" / "posix"
PORT_WIRE = ROOT / "port" / "wire"
PORT_MCU = ROOT / "port" / "mcu"
PORT_BROWSER = ROOT / "port" / "browser"
PORT_WASM = ROOT / "port" / "wasm"
FLAGS_FILE = ROOT / "flags.mk"


def flags(name: str) -> list[str]:
    """Return the flags that `flags.mk` assigns to `name` (SP_CFLAGS, SP_STRICT, SP_SHARED)."""
    found = re.search(rf"^{name} = (.*)$", FLAGS_FILE.read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        raise KeyError(name)
    return found.group(1).split()
