"""The whole job with no hardware: record on the simulated device, train, emit, validate, report."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter

from springpot import Fit, emit, read_scene, record, train, validate, write_model
from springpot.codegen.errors import UsageError
from springpot.host.console.output import progress_bar, progress_console
from springpot.host.emission.result import Emission
from springpot.host.report.scene_page import write_report
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import Validation

_MARK = ".springpot-demo"
_TRAINING_SEED, _VALIDATION_SEED = 1, 2


@dataclass(frozen=True)
class Demo:
    """Results of each step, and what it took: step -> s."""

    emission: Emission
    validation: Validation
    fit: Fit
    report: Path
    seconds: dict[str, float]


def run_demo(out: Path, object_name: str) -> Demo:
    """Run everything into `out`, replacing an earlier demo there. Raises UsageError otherwise."""
    _prepare(out)
    seconds: dict[str, float] = {}
    url = f"sim://{object_name}"
    with _step("record", seconds):
        training = record(url, "paper", out / "training", _TRAINING_SEED)
        testing = record(url, "validation", out / "validation", _VALIDATION_SEED)
    with _step("train", seconds):
        fit = train(training, name=object_name)
        model_file = out / "model.spm"
        write_model(model_file, fit.model)
    with _step("emit and build", seconds):
        with as_file(files("springpot.host") / "scenes" / "plain.toml") as shipped:
            shutil.copyfile(shipped, out / "scene.toml")
        scene = replace(read_scene(out / "scene.toml"), name=object_name)
        emission = emit(out / "c", model=model_file, scene=scene)
    with _step("validate", seconds):
        validation = validate(out / "c", testing)
        store_validation(out / "c", validation)
    with _step("report", seconds):
        report = write_report(out / "c")
    return Demo(emission, validation, fit, report, seconds)


def _prepare(out: Path) -> None:
    if out.exists() and any(out.iterdir()):
        if not (out / _MARK).exists():
            raise UsageError(f"{out}: not empty and no earlier demo: give --out a new folder")
        shutil.rmtree(out)
    out.mkdir(parents=True, exist_ok=True)
    (out / _MARK).touch()


@contextmanager
def _step(name: str, seconds: dict[str, float]) -> Iterator[None]:
    begin = perf_counter()
    with progress_bar(name):
        yield
    seconds[name] = perf_counter() - begin
    progress_console.print(f"{name}: {seconds[name]:.1f} s")
