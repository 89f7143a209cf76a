"""`springpot demo`, the whole job with no hardware, and `springpot report`."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path
from time import perf_counter

import click

from springpot.codegen.errors import UsageError
from springpot.host.options import PATH
from springpot.host.output import json_option, print_result, progress_bar, progress_console

_MARK = ".springpot-demo"
_TRAINING_SEED, _VALIDATION_SEED = 1, 2


@click.command()
@click.option(
    "--out", type=PATH, default=Path("demo"), show_default=True, help="Folder to write into."
)
@click.option(
    "--object", "object_name", default="ecoflex-00-30", show_default=True, help="Simulated object."
)
@json_option
def demo(out: Path, object_name: str, as_json: bool) -> None:
    """Do the whole job on a simulated object: record, train, emit, build, validate, report."""
    from springpot import emit, read_scene, record, train, validate, write_model
    from springpot.host.pages.reports import write_report
    from springpot.host.validation.store import store_validation
    from springpot.host.validation.validation import raise_on_mismatch

    _prepare(out)
    seconds: dict[str, float] = {}
    url, model_file, folder = f"sim://{object_name}", out / "model.spm", out / "c"
    with _step("record", seconds):
        training = record(url, "paper", out / "training", _TRAINING_SEED)
        testing = record(url, "validation", out / "validation", _VALIDATION_SEED)
    with _step("train", seconds):
        fit = train(training, name=object_name)
        write_model(model_file, fit.model)
    with _step("emit and build", seconds):
        with as_file(files("springpot.host") / "scenes" / "plain.toml") as shipped:
            shutil.copyfile(shipped, out / "scene.toml")
        scene = replace(read_scene(out / "scene.toml"), name=object_name)
        emission = emit(folder, model=model_file, scene=scene)
    with _step("validate", seconds):
        validation = validate(folder, testing)
        store_validation(folder, validation)
    with _step("report", seconds):
        page = str(write_report(folder))
        pressed = _press_page(folder, out / "press.html")
    result = {
        "object": object_name,
        "report": page,
        "press_page": pressed,
        "seconds": seconds,
        "emit": emission.as_dict(),
        "validate": validation.as_dict(),
    }
    rows = {
        "verdict": validation.verdict,
        "C": f"{folder / emission.manifest['sources'][0]}: {emission.flash_bytes} bytes of flash, "
        f"{emission.ram_bytes} of RAM",
        "report": page,
        "press it": pressed or "in a browser: springpot page, which needs clang and lld, or zig",
    }
    print_result(result, as_json, rows)
    raise_on_mismatch(folder, validation)


def _press_page(folder: Path, out: Path) -> str | None:
    """Write the page that presses the object in a browser; None without a compiler for it."""
    from springpot.host.pages.press_page import write_press_page

    try:
        write_press_page([folder], out)
    except UsageError:
        return None
    return str(out)


def _prepare(out: Path) -> None:
    """Make way for a demo in the place of an earlier one. Raises UsageError for anything else."""
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


@click.command()
@click.argument("folder", type=PATH)
@json_option
def report(folder: Path, as_json: bool) -> None:
    """Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene."""
    from springpot.host.pages.reports import write_bench_page, write_report

    with progress_bar("report"):
        is_bench = (folder / "bench.json").is_file()
        path = str(write_bench_page(folder) if is_bench else write_report(folder))
    print_result({"report": path}, as_json, {"report": path})
