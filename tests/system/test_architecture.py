"""Floors import only downwards, rooms in no circle, and nothing heavy where it is not used."""

import ast
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from support.pages.sources import FLOORS, sources
from support.paths import ROOT

FITS = {"sklearn", "scipy", "joblib"}
MAX_FILES = 15  # of a folder, __init__.py apart


@cache
def import_nodes(file: Path) -> list[ast.Import | ast.ImportFrom]:
    """Every import of a file, at its top or within a function."""
    return [
        node
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]


def imports(file: Path) -> list[str]:
    """Module names that a file imports."""
    found = []
    for node in import_nodes(file):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        else:
            assert node.level == 0, f"{file}: relative import"
            found.append(node.module or "")
    return found


@pytest.mark.few(1)
@pytest.mark.parametrize("floor", FLOORS)
def test_a_floor_imports_only_from_floors_below(floor: str) -> None:
    allowed = set(FLOORS[: FLOORS.index(floor) + 1])
    files = sorted((ROOT / floor).rglob("*.py"))
    assert files
    for file in files:
        for module in imports(file):
            if module.startswith("springpot."):
                assert module.split(".")[1] in allowed, f"{file} imports {module}"
            assert module != "springpot" or floor == "host", f"{file}: the root is above its floor"


def room_of(module: str) -> tuple[str, str] | None:
    """Floor and room of a module; None for what is none of springpot's, or a whole floor."""
    package, *path = module.split(".")
    return (path[0], path[1]) if package == "springpot" and len(path) > 1 else None


def imported(file: Path) -> Iterator[str]:
    """Modules that a file imports; of `from package import name`, both readings."""
    yield from imports(file)
    for node in import_nodes(file):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.count(".") < 2:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_no_rooms_import_each_other_in_a_circle() -> None:
    """Lazy imports, and those for checkers, count too."""
    known = {(floor, room) for _, floor, room in sources(*FLOORS)}
    needs: dict[tuple[str, str], set[tuple[str, str]]] = {room: set() for room in known}
    for file, floor, room in sources(*FLOORS):
        found = {room_of(module) for module in imported(file)}
        needs[floor, room] |= {one for one in found if one in known} - {(floor, room)}
    TopologicalSorter(needs).prepare()  # CycleError names the rooms


# Circles that stand: whoever mends one takes its line away, and nobody adds one.
KNOWN_CIRCLES = {("codegen.stages.passive.motion", "codegen.stages.passive.hammerstein")}


def test_no_files_import_each_other_in_a_circle() -> None:
    """Lazy imports, and those for checkers, count too."""
    files = {}
    for floor in ("codegen", "trainer", "host"):
        for file in (ROOT / floor).rglob("*.py"):
            files[".".join(file.relative_to(ROOT).with_suffix("").parts)] = file
    needs = {}
    for module, file in files.items():
        names = {name.removeprefix("springpot.") for name in imports(file)} | {
            f"{node.module}.{alias.name}".removeprefix("springpot.")
            for node in import_nodes(file)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        needs[module] = {
            name for name in names & files.keys() if (module, name) not in KNOWN_CIRCLES
        }
    assert sum(map(len, needs.values())) > len(files)  # the names are those of files
    TopologicalSorter(needs).prepare()  # CycleError names the files


def test_no_folder_is_crowded() -> None:
    crowded = {}
    for folder in {file.parent for file in ROOT.glob("[rcth]*/**/*.py")}:
        files = [file for file in folder.glob("*.py") if file.name != "__init__.py"]
        if len(files) > MAX_FILES:
            crowded[str(folder.relative_to(ROOT))] = len(files)
    assert not crowded


FITTING = {"bench", "study", "ensemble", "recording"}  # rooms of host


def test_only_what_fits_imports_what_fits() -> None:
    for file, floor, room in sources("runtime_c", "codegen", "host"):
        for module in imports(file):
            if not (floor == "host" and room in FITTING):
                assert module.split(".")[0] not in FITS, f"{file} imports {module}"


LIGHT = ("cli", "commands.validate", "native.scene_library", "commands.train",
         "commands.record", "study.session", "validation.validation")  # fmt: skip


def test_replaying_and_logging_load_no_fit() -> None:
    script = (
        f"import importlib, sys\nfor name in {LIGHT!r}:\n"
        "    importlib.import_module('springpot.host.' + name)\n"
        f"    print(name, {FITS!r} & {{name.split('.')[0] for name in sys.modules}})"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True)  # fmt: skip
    assert result.stdout.splitlines() == [f"{name} set()" for name in LIGHT]


@pytest.mark.slow
def test_a_wheel_is_whole_and_has_one_name_only(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps",
               "--no-build-isolation", "--wheel-dir", str(tmp_path), str(ROOT)]  # fmt: skip
    subprocess.run(command, check=True, capture_output=True)
    wheel = zipfile.ZipFile(next(tmp_path.glob("*.whl")))
    names = wheel.namelist()
    tops = {name.split("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"springpot"}
    for file in ROOT.glob("runtime_c/**/*"):
        if file.suffix in {".c", ".h", ".mk"}:
            assert f"springpot/{file.relative_to(ROOT)}" in names, file
    templates = [file for file in ROOT.glob("[ch]o*/**/templates/**/*") if file.is_file()]
    for file in [*ROOT.glob("host/scenes/*"), *templates]:
        assert f"springpot/{file.relative_to(ROOT)}" in names, file
    for folder in ("runtime_c", "codegen", "trainer", "host"):
        for file in (ROOT / folder).rglob("*.py"):
            assert f"springpot/{file.relative_to(ROOT)}" in names, file
    assert {"springpot/__init__.py", "springpot/py.typed"} <= set(names)
    assert not any(name.startswith(("springpot/tests", "springpot/docs")) for name in names)
    wheel.extractall(tmp_path / "installed")
    script = (
        "import springpot\n"
        "for name in dir(springpot): getattr(springpot, name)\n"
        "print(springpot.__file__, springpot.load.__code__.co_filename)"
    )
    package = tmp_path / "installed" / "springpot"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True, env={"PYTHONPATH": str(package.parent)})  # fmt: skip
    assert result.stdout.split() == [str(package / "__init__.py"), str(package / "host/loaded.py")]
