"""What four models cost on a Cortex-M4F: the table of docs/how-to/microcontroller.md.

    python tests/bench/boards.py [--write]

Fitted to the presses of the page's object, without a coupling; needs the cross compiler and the
emulator (`make setup-mcu`). --write: into the page.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.pages.figures import write_measured
from support.paths import ROOT

import springpot
from springpot.codegen.scene import Coupling, Runtime, Scene

PAGE = ROOT / "docs/how-to/microcontroller.md"
MODELS = {
    "hammerstein": ("hammerstein", {}),
    "rf-fd, as above": ("rf-fd", {"trees": 10, "leaf": 20}),
    "rbf-pv": ("rbf-pv", {}),
    "rbf-fd, 171 taps": ("rbf-fd", {}),
}
HEAD = """| model | flash, bytes | RAM | stack | instructions | after 19 ms of silence |
| --- | --- | --- | --- | --- | --- |"""


def row(name: str, presses: list[springpot.Recording]) -> str:
    """Measure a model; its line of the table."""
    kind, options = MODELS[name]
    model = springpot.train(presses, kind, "pad", **options).model
    scene = Scene(1, "my object", "model.spm", coupling=Coupling("off"),
                  runtime=Runtime(target="cortex-m4f"))  # fmt: skip
    with tempfile.TemporaryDirectory() as scratch:
        emission = springpot.emit(Path(scratch) / "c", model=model, scene=scene, accept_unsafe=True)
    cost = emission.cost
    sizes = (emission.flash_bytes, emission.ram_bytes, emission.stack_bytes)
    return f"| {' | '.join(map(str, (name, *sizes, cost.usual, cost.after_silence)))} |"


def presses() -> list[springpot.Recording]:
    """Record the page's object."""
    with tempfile.TemporaryDirectory() as scratch:
        return springpot.record("sim://ecoflex-00-30", "paper", Path(scratch) / "training")


def main() -> None:
    """Measure; print, and write where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--write", action="store_true", help=str(PAGE.relative_to(ROOT)))
    asked, recorded = parser.parse_args(), presses()
    table = "\n".join([HEAD, *(row(name, recorded) for name in MODELS)])
    print(table)
    if asked.write:
        write_measured(PAGE, "boards", table)


if __name__ == "__main__":
    main()
