"""`springpot demo`, the whole job with no hardware, and `springpot report`."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter

import click

from springpot import Fit, emit, read_scene, record, train, validate, write_model
from springpot.codegen.errors import UsageError
from springpot.host.emission.result import Emission
from springpot.host.output import json_option, print_result, progress_bar, progress_console
from springpot.host.pages.scene_page import write_report
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import Validation


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("demo"), show_default=True)
@click.option("--object", "object_name", default="ecoflex-00-30", show_default=True)
@json_option
def demo(out: Path, object_name: str, as_json: bool) -> None:
    """Do the whole job on a simulated object: record, train, emit, build, validate, report."""
    from springpot.host.commands.demo import run_demo
    from springpot.host.commands.emit import emission_rows
    from springpot.host.validation.store import validation_rows
    from springpot.host.validation.validation import fail_on_mismatch

    done = run_demo(out, object_name)
    result = {
        "object": object_name,
        "report": str(done.report),
        "seconds": done.seconds,
        "emit": done.emission.as_dict(),
        "validate": done.validation.as_dict(),
    }
    rows = {
        "object": f"{object_name}, simulated",
        "training": f"{done.fit.rows} rows, fit {done.fit.fit_s:.2f} s",
        **emission_rows(done.emission),
        **validation_rows(done.validation),
        "report": str(done.report),
    }
    print_result(result, as_json, rows)
    fail_on_mismatch(out / "c", done.validation)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."""
    from springpot.host.pages.bench_page import write_bench_page
    from springpot.host.pages.scene_page import write_report

    with progress_bar("report"):
        if (folder / "bench.json").is_file():
            path = write_bench_page(folder)
        else:
            path = write_report(folder)
    print_result({"report": str(path)}, as_json, {"report": str(path)})


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
