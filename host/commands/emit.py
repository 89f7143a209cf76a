"""`springpot emit`, `build`, `firmware`: C source, and what is made of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from springpot.host.emission.boards import BOARDS, find_board
from springpot.host.options import PATH, recordings_option, scene_options, scene_or_folder_option
from springpot.host.output import json_option, print_line, print_result, progress_bar
from springpot.runtime_c.paths import flags

if TYPE_CHECKING:
    from springpot.codegen.model.model import Model
    from springpot.host.emission.result import Emission
    from springpot.trainer.recordings.recording import Recording


@click.command(name="emit")
@scene_options
@click.option("--out", type=PATH, required=True, help="Folder to write.")
@click.option(
    "--accept-unsafe",
    is_flag=True,
    help="Emit an unstable scene anyway, for replay only (recorded in the manifest).",
)
@recordings_option("--recording", "recordings", "What --fit measures smaller forests on")
@click.option("--fit", is_flag=True, help="Make a forest smaller until it fits the budget.")
@json_option
def emit_(
    scene_file: Path | None,
    model_file: Path | None,
    out: Path,
    accept_unsafe: bool,
    recordings: tuple[str, ...],
    fit: bool,
    as_json: bool,
) -> None:
    """Emit a scene as one C source and one header; from a scene file or a model."""
    from springpot.host.emission.budget_fit import emit_fitting
    from springpot.host.files import given_scene_and_model

    scene, model = given_scene_and_model(scene_file, model_file)
    measured = _recordings(recordings, model) if recordings else []
    with progress_bar("emit"):
        emission = emit_fitting(scene, model, out, accept_unsafe, measured, fit)
    for notice in emission.notices:
        print_line(notice)
    print_result(emission.as_dict(), as_json, emission_rows(emission))


def _recordings(names: tuple[str, ...], model: Model) -> list[Recording]:
    """Read what smaller versions are measured on; say which of them the model has seen."""
    from springpot.host.validation.seen import count_training_recordings, training_overlap_sentence
    from springpot.trainer.recordings.recording_file import read_recordings

    recordings = read_recordings(map(Path, names))
    if seen := training_overlap_sentence(
        count_training_recordings(model, recordings), len(recordings)
    ):
        print_line(seen)
    return recordings


def emission_rows(emission: Emission) -> dict[str, str]:
    """Return what a command prints of an emission."""
    flash, stack = emission.flash_bytes, emission.stack_bytes
    left_out, dt_s = emission.manifest["left_out"], emission.manifest["dt_s"]
    cost, optimised = emission.cost, next(f for f in flags("SP_CFLAGS") if f.startswith("-O"))
    counted = cost.usual and f"{cost.usual} in a tick, {cost.after_silence} in the first after "
    return {
        "C source": str(emission.folder),
        "tick": f"{1.0 / dt_s:.6g} Hz: call the step every {1e3 * dt_s:.4g} ms; after a "
        f"silence one call does up to {round(emission.plan.watchdog_s / dt_s)} ticks' work",
        "size": f"{emission.plan.scene.runtime.target}, {optimised}: "
        f"{'?' if flash is None else flash} bytes of flash "
        f"({emission.selftest_bytes or '?'} more with the self-test), {emission.ram_bytes} of RAM, "
        f"{'?' if stack is None else stack} of stack",
        **(
            {"instructions": f"{counted}the longest silence ({cost.why})" if counted else cost.why}
            if emission.plan.scene.runtime.target != "host"
            else {}
        ),
        "coupling": emission.manifest["coupling"]["why"],
        "stiffness felt": f"{1e-3 * emission.manifest['coupling']['felt_stiffness_npm']:.3g} N/mm",
        "outside": emission.manifest["outside"],
        "stability": _stability(emission),
        "left out": f"{', '.join(item['what'] for item in left_out) or 'nothing'} "
        f"({sum(item['bytes'] for item in left_out)} bytes of RAM)",
    }


def _stability(emission: Emission) -> str:
    """Return what the check at emission says of the loop and of small motions."""
    checked = emission.check
    if checked is None:
        return "not checked"
    active, cells = checked.model_map.active(False)
    return (
        f"{checked.sentence} No energy given in {cells - active} of {cells} small motions; "
        "whole sessions: springpot stability"
    )


@click.command()
@click.argument("folder", type=PATH)
@json_option
def build(folder: Path, as_json: bool) -> None:
    """Build an emitted FOLDER's shared library in the cache; print its path."""
    from springpot.host.emission.checksums import edited_files
    from springpot.host.emission.emission import require_emission
    from springpot.host.native.scene_library import build_scene

    require_emission(folder)
    edited = edited_files(folder)
    library = build_scene(folder)
    if as_json:
        print_result({"library": str(library), "edited": list(edited)}, True, {})
    else:
        click.echo(library)


@click.command()
@scene_or_folder_option
@click.option("--board", "name", required=True, help=f"One of {', '.join(BOARDS)}.")
@click.option("--out", type=PATH, required=True, help="Folder to write.")
@json_option
def firmware(scene: Path, name: str, out: Path, as_json: bool) -> None:
    """Build a board's firmware; all its sources lie beside it."""
    from springpot.host.emission.boards import TRANSDUCER, build_firmware
    from springpot.host.emission.checksums import is_edited
    from springpot.host.emission.emission import emitted_folder, read_emission

    board = find_board(name)
    if is_edited(out, TRANSDUCER):
        print_line(f"{out / TRANSDUCER}: built as you changed it")
    with progress_bar("firmware"), emitted_folder(scene) as folder:
        program = build_firmware(folder, read_emission(folder).plan, board, out)
    print_result(
        {"firmware": str(program), "board": board.name, "target": board.target},
        as_json,
        {"firmware": str(program)},
    )
