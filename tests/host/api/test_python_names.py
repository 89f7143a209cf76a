"""The names of `import springpot`: there, described, and loaded only when they are used."""

import doctest
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.pages.sources import API
from support.paths import ROOT
from support.small import press, scene, small_model

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
    assert {name for name in loaded if name.startswith("springpot")} == {
        "springpot", "springpot.lazy_names",
    }  # fmt: skip
    assert not loaded & {"numpy", "click", "rich", "h5py", "pydantic", "cffi", "importlib.metadata"}


def test_every_name_is_there_and_says_what_it_is() -> None:
    assert springpot.__all__ == sorted(springpot.__all__)
    assert set(dir(springpot)) == {*springpot.__all__, "__version__"}
    assert re.fullmatch(r"\d+\.\d+\.\d+", springpot.__version__)
    for name in springpot.__all__:
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


def test_no_name_hides_a_folder_or_a_module() -> None:
    modules = {file.stem for file in (ROOT / "host" / "api").glob("*.py")} - {"__init__"}
    assert not {*springpot.__all__} & (modules | FLOORS)
    assert not modules & FLOORS


def test_the_package_has_one_name() -> None:
    with pytest.raises(ImportError, match="import springpot"):
        importlib.import_module("springpot.host.api")


INNER = {"__init__", "files", "lazy_names", "loaded", "steps"}
PUBLIC = sorted({file.stem for file in API.glob("*.py")} - INNER)


@pytest.mark.parametrize("name", PUBLIC)
def test_names_of_a_public_module_are_there_and_its_example_runs(name: str, tmp_path: Path) -> None:
    module = importlib.import_module(f"springpot.{name}")
    assert module.__all__ == sorted(module.__all__) == dir(module)
    for public in module.__all__:
        assert hasattr(module, public), public
    with pytest.raises(AttributeError, match="no_such"):
        module.no_such  # noqa: B018
    around = {
        "folder": tmp_path,
        "model": small_model(),
        "scene": scene("float32", "tool"),
        "press_m": press(2.0).astype("float32"),
    }
    example = doctest.DocTestParser().get_doctest(module.__doc__ or "", around, name, None, 0)
    assert example.examples
    failed, _ = doctest.DocTestRunner().run(example)
    assert failed == 0
