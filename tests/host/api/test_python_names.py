"""The names of `import springpot`: there, described, and loaded only when they are used."""

import inspect
import re
import subprocess
import sys

import springpot

FLOORS = {"codegen", "trainer", "host", "runtime_c"}


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


def test_every_name_is_there_and_says_what_it_is() -> None:
    assert len(dir(springpot)) <= 24
    assert re.fullmatch(r"\d+\.\d+\.\d+", springpot.__version__)
    for name in dir(springpot):
        found = getattr(springpot, name)
        assert found.__name__ == name
        assert found.__doc__, name
        assert not found.__doc__.startswith(f"{name}("), f"{name}: a dataclass without a docstring"
        for method, member in inspect.getmembers(found, inspect.isfunction):
            if (
                inspect.isclass(found)
                and not method.startswith("_")
                and "springpot" in str(inspect.getmodule(member))
            ):
                assert inspect.getdoc(member), f"{name}.{method}"
