"""The names of `import springpot`: there, described, and loaded only when they are used."""

import subprocess
import sys


def modules_after(statement: str) -> set[str]:
    """Top-level modules of a fresh interpreter, and springpot's own."""
    script = (
        f"import sys\nbefore = set(sys.modules)\n{statement}\nprint(*set(sys.modules) - before)"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True)  # fmt: skip
    return set(result.stdout.split())


def test_import_alone_loads_nothing() -> None:
    loaded = modules_after("import springpot; dir(springpot)")
    assert {name for name in loaded if name.startswith("springpot")} == {"springpot"}
    assert not loaded & {"numpy", "click", "rich", "h5py", "pydantic", "cffi", "importlib.metadata"}
