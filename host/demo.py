"""The whole job with no hardware: record on the simulated device, train, emit, validate, report."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter
from typing import Any

from springpot.codegen.errors import UsageError
from springpot.codegen.model.model_file import write_model
from springpot.host.console.output import progress_bar, progress_console
from springpot.host.emission.emission import emit
from springpot.host.emission.result import Emission
from springpot.host.emission.scene_file import read_scene
from springpot.host.recording.protocols import load_protocol
from springpot.host.recording.session import open_press_device, record_session
from springpot.host.validation.report import write_report
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import Validation, validate
from springpot.trainer.recordings.recording_file import read_recordings

_MARK = ".springpot-demo"
_TRAINING_SEED, _VALIDATION_SEED = 1, 2


@dataclass(frozen=True)
class Demo:
    """Results of each step, and what it took: step -> s."""

    emission: Emission
    validation: Validation
    fit: Any
    report: Path
    seconds: dict[str, float]


def run_demo(out: Path, object_name: str) -> Demo:
    """Run everything into `out`, replacing an earlier demo there. Raises UsageError otherwise."""
    _prepare(out)
    seconds: dict[str, float] = {}
    with _step("record", seconds):
        _record(object_name, "paper", _TRAINING_SEED, out / "training")
        _record(object_name, "validation", _VALIDATION_SEED, out / "validation")
    training, testing = (read_recordings([out / name]) for name in ("training", "validation"))
    with _step("train", seconds):
        from springpot.trainer.kinds import AUTO, fit_model
        from springpot.trainer.models.fit import FitOptions

        fit = fit_model(AUTO, object_name, training, FitOptions())
        model_file = out / "model.spm"
        write_model(model_file, fit.model)
    with _step("emit and build", seconds):
        with as_file(files("springpot.host") / "scenes" / "plain.toml") as shipped:
            shutil.copyfile(shipped, out / "scene.toml")
        scene = replace(read_scene(out / "scene.toml"), name=object_name)
        emission = emit(scene, model_file, out / "c")
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


def _record(object_name: str, protocol: str, seed: int, folder: Path) -> None:
    url = f"sim://{object_name}"
    device = open_press_device(url, seed)
    record_session(device, url, protocol, load_protocol(protocol, seed), folder, lambda _: None)


@contextmanager
def _step(name: str, seconds: dict[str, float]) -> Iterator[None]:
    begin = perf_counter()
    with progress_bar(name):
        yield
    seconds[name] = perf_counter() - begin
    progress_console.print(f"{name}: {seconds[name]:.1f} s")
