"""One meaning a name, and kinds that answer for themselves."""

import ast
import collections
from collections.abc import Iterator
from pathlib import Path

from support.pages.sources import sources
from support.paths import ROOT

# Rooms of what comes in kinds: others ask its methods, and not which it is.
KINDS = ["codegen/model/features.py", "codegen/model/regressors.py", "codegen/stages",
         "host/devices", "host/wings/devices", "host/session", "host/recording"]  # fmt: skip


def public_names(file: Path) -> Iterator[str]:
    """Names that a module defines for others."""
    for node in ast.parse(file.read_text()).body:
        match node:
            case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                names = [name]
            case ast.Assign(targets=targets):
                stored = (item for target in targets for item in ast.walk(target))
                names = [item.id for item in stored if isinstance(item, ast.Name)]
            case ast.AnnAssign(target=ast.Name(id=name)):
                names = [name]
            case _:
                names = []
        yield from (name for name in names if not name.startswith("_"))


def test_no_two_modules_define_the_same_public_name() -> None:
    homes = collections.defaultdict(list)
    for file, _, room in sources("codegen", "trainer", "host"):
        if room != "api":  # offers what rooms do, by the same names
            for name in set(public_names(file)):
                homes[name].append(str(file.relative_to(ROOT)))
    assert not {name: files for name, files in homes.items() if len(files) > 1}


def test_no_two_files_of_c_have_the_same_name() -> None:
    files = [file for file in (ROOT / "runtime_c").rglob("*.[ch]") if file.stem != "sp_real"]
    names = [file.name for file in files]  # sp_real.h: one for each number type
    assert len(set(names)) == len(names)
    assert len({file.stem for file in files if file.suffix == ".c"}) == len(
        [file for file in files if file.suffix == ".c"]
    )


def classes_asked_for(file: Path) -> Iterator[str]:
    """Names of classes in isinstance, and in the patterns of a match."""
    for node in ast.walk(ast.parse(file.read_text())):
        match node:
            case ast.Call(func=ast.Name(id="isinstance"), args=[_, asked]):
                pass
            case ast.MatchClass(cls=asked):
                pass
            case _:
                continue
        for item in ast.walk(asked):
            match item:
                case ast.Name(id=name) | ast.Attribute(attr=name):
                    yield name


def test_nobody_asks_which_kind_it_is() -> None:
    homes = {}
    for place in KINDS:
        root = ROOT / place
        for file in [root] if root.is_file() else root.rglob("*.py"):
            for node in ast.parse(file.read_text()).body:
                if isinstance(node, ast.ClassDef):
                    homes[node.name] = root if root.is_dir() else root.parent
    assert {"FirBank", "Forest", "SerialDevice", "CLoop", "PressedDevice"} <= set(homes)
    wrong = [
        f"{file.relative_to(ROOT)}: {name}"
        for file, _, _ in sources("codegen", "trainer", "host")
        for name in classes_asked_for(file)
        if name in homes and homes[name] not in file.parents
    ]
    assert not wrong, "\n".join(wrong)
