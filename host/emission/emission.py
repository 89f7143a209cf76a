"""Emission: files written aside, built, self-tested, and only then renamed into place."""

import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from springpot.codegen.emit.files import emit_files
from springpot.codegen.errors import BudgetError, DataError, MismatchError, UsageError
from springpot.codegen.files import write_folder_atomically
from springpot.codegen.make_plan import make_plan
from springpot.codegen.messages import short_repr
from springpot.codegen.model.model import Model
from springpot.codegen.model.model_file import MODEL_SUFFIX, read_model, write_model
from springpot.codegen.native.compiler import NoCompilerError
from springpot.codegen.plan import Plan, state_bytes
from springpot.codegen.scene import Scene
from springpot.host.emission.boards import count_instructions
from springpot.host.emission.checksums import (
    edited_files,
    edited_hash,
    require_replaceable,
    write_checksums,
)
from springpot.host.emission.result import (
    Emission,
    coupling_notices,
    over_budget,
    rate_notices,
    vibration_notices,
)
from springpot.host.emission.scene_file import (
    model_path,
    read_scene,
    scene_from_json,
    scene_to_json,
)
from springpot.host.native.scene_library import SceneLibrary, read_manifest
from springpot.host.native.toolchain import (
    SOFT_DOUBLES,
    measure_footprint,
)
from springpot.host.output import print_line
from springpot.host.stability.check import Check, check
from springpot.host.stability.linear import require_stable

# What the C was made from, beside it: whoever holds the folder can check it, and emit it again.
MODEL_COPY = "from/model.spm"
SCENE_COPY = "from/scene.json"


def emit(scene: Scene, model: Model | Path, folder: Path, accept_unsafe: bool = False) -> Emission:
    """Emit `scene` of a model, or of its file, into `folder`, replacing an earlier emission there.

    Raises UsageError where the folder holds anything else, BudgetError where the C does not fit
    the scene's budget, MismatchError where its self-test fails, UnsafeError where a hand would
    find it unstable, unless that is accepted: the manifest then says so.
    """
    require_replaceable(folder)
    if isinstance(model, Path):
        model = read_model(model)
    plan = make_plan(model, scene, accept_unsafe)
    if not accept_unsafe:
        require_stable(plan)
    with write_folder_atomically(folder) as aside:
        begin = time.perf_counter()
        write_emission(plan, plan.scene, model, aside)
        write_s = time.perf_counter() - begin
        return _built(plan, aside, folder, write_s)


@dataclass(frozen=True, eq=False)
class Emitted:
    """An emitted folder read back.

    edited: files that are not as emitted. hash: of the emission, and of them.
    """

    plan: Plan
    model: Model
    edited: tuple[str, ...]
    hash: str
    __repr__ = short_repr


def require_emission(folder: Path) -> None:
    """Raise DataError where the folder is none of `emit`."""
    if (folder / SCENE_COPY).exists():
        return
    if folder.suffix == MODEL_SUFFIX:
        raise DataError(
            f"{folder}: a model, not an emitted folder: "
            f"`springpot emit --model {folder} --out FOLDER` makes one"
        )
    raise DataError(f"{folder}: not an emitted folder: `springpot emit --out` makes one")


def read_emission(folder: Path) -> Emitted:
    """Read back the plan of an emitted folder from what it was made from.

    Raises DataError where there is none; a file that is not as emitted is a UserWarning.
    """
    require_emission(folder)
    edited = edited_files(folder)
    model = read_model(folder / MODEL_COPY)
    scene = scene_from_json(
        (folder / SCENE_COPY).read_text(encoding="utf-8"), str(folder / SCENE_COPY)
    )
    metadata = read_manifest(folder)
    plan = make_plan(model, scene, bool(metadata["accept_unsafe"]))
    return Emitted(plan, model, edited, edited_hash(str(metadata["hash"]), folder, edited))


def write_emission(plan: Plan, scene: Scene, model: Model, folder: Path) -> None:
    """Write a plan's files into a new folder, with what they were made from."""
    (folder / "from").mkdir(parents=True)
    for name, text in emit_files(plan).items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    (folder / SCENE_COPY).write_text(scene_to_json(scene), encoding="utf-8", newline="\n")
    write_model(folder / MODEL_COPY, model)
    write_checksums(folder)


def _built(plan: Plan, aside: Path, folder: Path, write_s: float) -> Emission:
    """Build a new emission, run its self-test, measure its sizes and check its loop."""
    notices = [*rate_notices(plan), *coupling_notices(plan), *_unchecked(plan)]
    footprint = selftest_bytes = compile_s = checked = None
    unmeasured = ""
    try:
        begin = time.perf_counter()
        library = SceneLibrary(aside)
        compile_s = time.perf_counter() - begin
        if differs := library.selftest():
            raise MismatchError(
                f"{plan.scene.name}: the built C differs from its numpy reference at golden tick "
                f"{differs - 1}: nothing was emitted; correct a stage of your own, or report the "
                f"compiler ({library.path})"
            )
        try:
            footprint = measure_footprint(aside, plan.scene.runtime.target)
            whole = measure_footprint(aside, plan.scene.runtime.target, selftest=True)
            selftest_bytes = whole.flash_bytes - footprint.flash_bytes
        except NoCompilerError as error:
            unmeasured = str(error)
            notices.append(f"flash and stack could not be measured: {error}")
        checked = check(plan, library)
        if not plan.accept_unsafe:
            checked.require_stable()
        notices += [*_activity(checked), *vibration_notices(checked)]
    except NoCompilerError as error:
        unmeasured = str(error)
        notices.append(f"not built, so flash and stack could not be measured: {error}")
    metadata = read_manifest(aside)
    emission = Emission(
        folder=folder,
        plan=plan,
        manifest=metadata,
        hash=metadata["hash"],
        footprint=footprint,
        selftest_bytes=selftest_bytes,
        cost=count_instructions(aside, plan),
        unmeasured=unmeasured,
        ram_bytes=state_bytes(plan),
        write_s=write_s,
        compile_s=compile_s,
        check=checked,
        notices=tuple(notices),
    )
    if over := over_budget(emission, plan.scene.budget):
        raise BudgetError(over)
    return emission


def _activity(checked: Check) -> list[str]:
    """Return a warning where the model is not passive; never a refusal."""
    cells = []
    for outside, where in ((False, ""), (True, " beyond the trained depth")):
        active, tried = checked.model_map.active(outside)
        cells += [f"{active} of {tried} small-signal cells{where}"] if active else []
    return cells and [
        f"the model is not passive in {', and in '.join(cells)}: `springpot stability` shows what "
        "a hand makes of it"
    ]


def _unchecked(plan: Plan) -> list[str]:
    """Say what of the scene an emission does not check or count."""
    scene = plan.scene
    messages = []
    if scene.budget.tick_us is not None:
        messages.append(
            "budget.tick_us is not checked at emission: `springpot validate` measures it"
        )
    if scene.runtime.number == "float64" and scene.runtime.target in SOFT_DOUBLES:
        messages.append(
            f"float64 on {scene.runtime.target}: doubles run in software there, and the flash of "
            "their library is not counted"
        )
    return messages


@contextmanager
def emitted_folder(scene: Path) -> Iterator[Path]:
    """The folder itself, or that of a scene file emitted for this session."""
    if (scene / SCENE_COPY).exists():
        yield scene
        return
    if scene.is_dir():
        raise UsageError(f"{scene}: not an emitted folder: `springpot emit --out` makes one")
    described = read_scene(scene)
    with tempfile.TemporaryDirectory(prefix="springpot-run-") as scratch:
        folder = Path(scratch) / "c"
        for line in emit(described, model_path(described, scene), folder).notices:
            print_line(line)
        yield folder
