"""The floors: imports only downwards, and nothing heavy where it is not used."""

import ast
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from support.paths import ROOT

FLOORS = ["runtime_c", "codegen", "trainer", "host"]
FITS = {"sklearn", "scipy", "joblib"}
API = ROOT / "host" / "api"  # the modules of the package springpot itself


def imports(file: Path) -> list[tuple[str, bool]]:
    """Module names that a file imports, and whether at its top."""
    tree = ast.parse(file.read_text())
    top = set(map(id, tree.body))
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, id(node) in top) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            found.append((node.module or "", id(node) in top))
    return found


@pytest.mark.parametrize("floor", FLOORS)
def test_a_floor_imports_only_from_floors_below(floor: str) -> None:
    allowed = set(FLOORS[: FLOORS.index(floor) + 1])
    files = sorted((ROOT / floor).rglob("*.py"))
    assert files
    for file in files:
        own = {sibling.stem for sibling in API.glob("*.py")} if file.parent == API else set()
        for module, _ in imports(file):
            assert module != "springpot", f"{file}: the rooms are below the package springpot"
            if module.startswith("springpot."):
                assert module.split(".")[1] in allowed | own, f"{file} imports {module}"


def test_only_the_trainer_imports_what_fits() -> None:
    for floor in ("runtime_c", "codegen", "host"):
        for file in (ROOT / floor).rglob("*.py"):
            for module, _ in imports(file):
                assert module.split(".")[0] not in FITS, f"{file} imports {module}"


@pytest.mark.parametrize(
    "name",
    ["cli", "commands.scenes.validate", "native.scene_library", "commands.models.train",
     "commands.recordings.record"],
)  # fmt: skip
def test_replaying_and_logging_load_no_fit(name: str) -> None:
    module = f"springpot.host.{name}"
    script = (
        f"import sys, {module}\n"
        f"print(sorted({FITS!r} & {{name.split('.')[0] for name in sys.modules}}))"
    )
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                            check=True)  # fmt: skip
    assert result.stdout.strip() == "[]"


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
    for file in [*ROOT.glob("host/scenes/*"), *ROOT.glob("[ch]o*/**/templates/*")]:
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


def test_the_lock_holds_names_versions_and_hashes_only() -> None:
    text = (ROOT / "requirements.lock").read_text()
    assert "http" not in text
    assert "--index" not in text
    packages = [line for line in text.splitlines() if line and not line.startswith((" ", "#"))]
    assert all("==" in line for line in packages)
    assert text.count("--hash=sha256:") >= len(packages)
