"""Floors, rooms and wings: imports only downwards, and nothing heavy where it is not used."""

import ast
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from support.pages.sources import API, FLOORS, sources
from support.paths import ROOT

from springpot.lazy_names import homes_of

FITS = {"sklearn", "scipy", "joblib"}
# Folders and files of a floor, lowest first. Lazy imports, and those for checkers, count too.
ROOMS = {
    "runtime_c": ["paths"],
    "codegen": ["errors", "entry_points", "short_repr", "plurals", "arrays", "progress",
                "regular_file", "atomic_write", "scene", "literals", "model", "forest", "stages",
                "coupling", "plan", "reference", "emit"],
    "trainer": ["paper", "plot_axes", "recordings", "features", "models", "kinds", "selection"],
    "host": ["console", "metrics", "stiffness", "native", "simulation",
             "stability", "emission", "devices", "session", "recording", "validation",
             "commands", "api", "cli", "wings"],
}  # fmt: skip
WINGS = ROOT / "host" / "wings"
WING_MODULES = "springpot.host.wings."
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


@pytest.mark.parametrize("floor", FLOORS)
def test_a_floor_imports_only_from_floors_below(floor: str) -> None:
    allowed = set(FLOORS[: FLOORS.index(floor) + 1])
    files = sorted((ROOT / floor).rglob("*.py"))
    assert files
    for file in files:
        own = {sibling.stem for sibling in API.glob("*.py")} if file.parent == API else set()
        for module in imports(file):
            assert module != "springpot" or WINGS in file.parents, (
                f"{file}: the rooms are below the package springpot"
            )
            if WINGS not in file.parents and module.startswith("springpot."):
                assert module.split(".")[1] in allowed | own, f"{file} imports {module}"


def room_of(module: str, api: set[str]) -> tuple[str, str] | None:
    """Floor and room of a module; None for what is none of springpot's, or a whole floor."""
    package, *path = module.split(".")
    if package != "springpot" or not path:
        return None
    if path[0] in api:
        return "host", "api"
    return (path[0], path[1]) if len(path) > 1 else None


def imported(file: Path) -> Iterator[str]:
    """Modules that a file imports; of `from package import name`, both readings."""
    yield from imports(file)
    for node in import_nodes(file):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.count(".") < 2:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_rooms_import_only_from_rooms_below() -> None:
    api = {file.stem for file in API.glob("*.py")}
    wrong = []
    for file, floor, room in sources(*FLOORS):
        assert room in ROOMS[floor], f"{file}: a room that ROOMS does not place"
        for module in imported(file):
            found = room_of(module, api)
            if found is not None and found[0] == floor and found[1] in ROOMS[floor]:
                if room == "api" and module.startswith(WING_MODULES):
                    continue  # test_the_core_imports_no_wing
                order = ROOMS[floor]
                if order.index(found[1]) > order.index(room):
                    wrong.append(f"{file.relative_to(ROOT)}: {module}")
    assert not wrong, "\n".join(wrong)


def test_every_room_is_there() -> None:
    for floor, rooms in ROOMS.items():
        assert {room for _, its, room in sources(floor) if its == floor} == set(rooms)


def test_no_folder_is_crowded() -> None:
    crowded = {}
    for folder in {file.parent for file in ROOT.glob("[rcth]*/**/*.py")}:
        files = [file for file in folder.glob("*.py") if file.name != "__init__.py"]
        if len(files) > MAX_FILES:
            crowded[str(folder.relative_to(ROOT))] = len(files)
    assert not crowded


def test_a_wing_reaches_the_core_through_public_names_and_no_other_wing() -> None:
    public = {"springpot", *(f"springpot.{file.stem}" for file in API.glob("*.py"))}
    for file in WINGS.rglob("*.py"):
        wing = file.relative_to(WINGS).parts[0]
        own = f"springpot.host.wings.{wing}"
        for module in imports(file):
            if module.split(".")[0] == "springpot":
                assert module in public or module == own or module.startswith(f"{own}."), (
                    f"{file.relative_to(ROOT)} imports {module}"
                )


def test_the_core_imports_no_wing() -> None:
    for file, _, _ in sources(*FLOORS):
        if WINGS not in file.parents:
            named = {module for module in imports(file) if module.startswith(WING_MODULES)}
            if file.parent == API:  # names that are looked up when they are first used
                assert named <= set(homes_of(file).values()), f"{file} imports {named}"
            else:
                assert not named, f"{file} imports {named}"


def test_only_the_trainer_and_wings_import_what_fits() -> None:
    for floor in ("runtime_c", "codegen", "host"):
        for file in (ROOT / floor).rglob("*.py"):
            if WINGS in file.parents:
                continue
            for module in imports(file):
                assert module.split(".")[0] not in FITS, f"{file} imports {module}"


LIGHT = ("cli", "commands.scenes.validate", "native.scene_library", "commands.models.train",
         "commands.recordings.record", "wings.study.session")  # fmt: skip


def test_replaying_and_logging_load_no_fit() -> None:
    script = (
        f"import importlib, sys\nfor name in {LIGHT!r}:\n"
        "    importlib.import_module('springpot.host.' + name)\n"
        f"    print(name, {FITS!r} & {{name.split('.')[0] for name in sys.modules}})"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True)  # fmt: skip
    assert result.stdout.splitlines() == [f"{name} set()" for name in LIGHT]


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
            place = file.relative_to(API if API in file.parents else ROOT)
            assert f"springpot/{place}" in names, file
    assert "springpot/py.typed" in names
    assert not any(name.startswith("springpot/host/api") for name in names)
    wheel.extractall(tmp_path / "installed")
    script = (
        "import springpot\n"
        "for name in springpot.__all__: getattr(springpot, name)\n"
        "print(springpot.__file__, springpot.load.__code__.co_filename)"
    )
    package = tmp_path / "installed" / "springpot"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True, env={"PYTHONPATH": str(package.parent)})  # fmt: skip
    assert result.stdout.split() == [str(package / "__init__.py"), str(package / "loaded.py")]
