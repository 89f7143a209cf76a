"""The names of `import springpot`: there, described, and loaded only when they are used."""

import dataclasses
import doctest
import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest
from support.pages.sources import API
from support.paths import ROOT, TESTS
from support.small import passive_model, press, scene, small_model

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


def test_no_name_leaves_the_public_modules_unsaid() -> None:
    """A name goes with a new major version: tests/golden/public_names.txt is edited then."""
    now = [f"springpot.{name}" for name in springpot.__all__]
    for module in PUBLIC:
        names = importlib.import_module(f"springpot.{module}").__all__
        now += [f"springpot.{module}.{name}" for name in names]
    stored = (TESTS / "golden" / "public_names.txt").read_text().split()
    assert not set(stored) - set(now)


def is_plain(kind) -> bool:
    """Tell whether a field is a number, a truth, one of some words, or a name."""
    parts = get_args(kind)
    if hasattr(kind, "__metadata__"):
        return is_plain(parts[0])
    return kind in (int, float, bool, str, type(None)) or (
        bool(parts) and all(isinstance(part, str | int) or is_plain(part) for part in parts)
    )


def test_every_public_dataclass_has_a_short_line() -> None:
    """Require that a repr that Python writes has few fields, and no long one."""
    long = []
    for module in (springpot, *(importlib.import_module(f"springpot.{name}") for name in PUBLIC)):
        for kind in (getattr(module, name) for name in module.__all__):
            if dataclasses.is_dataclass(kind) and hasattr(kind.__repr__, "__wrapped__"):
                shown = [field for field in dataclasses.fields(kind) if field.repr]
                if len(shown) > 8 or not all(is_plain(field.type) for field in shown):
                    long.append(kind.__name__)
    assert not long
    plan = springpot.emission.make_plan(passive_model(), springpot.Scene(1, "a", "b.spm"))
    options = springpot.FitOptions(orders=(0.1,) * 99, seed=3)
    assert all(len(repr(each)) <= 200 for each in (plan, passive_model().hammerstein, options))
    assert repr(springpot.FitOptions(seed=3)) == "FitOptions(seed=3)"
