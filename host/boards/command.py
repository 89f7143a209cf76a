"""`springpot firmware`: a scene, built for a board."""

from pathlib import Path

import click

from springpot.host.boards.boards import BOARDS, board_of
from springpot.host.console.output import json_option, print_result, progress_bar, say


@click.command()
@click.option(
    "--scene",
    type=click.Path(path_type=Path),
    required=True,
    help="Scene file, or a folder that `springpot emit` wrote.",
)
@click.option("--board", "name", required=True, help=f"One of {', '.join(BOARDS)}.")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder to write.")
@json_option
def firmware(scene: Path, name: str, out: Path, as_json: bool) -> None:
    """Build a board's firmware; all its sources lie beside it."""
    from springpot.host.boards.firmware import TRANSDUCER, build_firmware
    from springpot.host.emission.checksums import is_edited
    from springpot.host.emission.emission import emitted_folder

    board = board_of(name)
    if is_edited(out, TRANSDUCER):
        say(f"{out / TRANSDUCER}: built as you changed it")
    with progress_bar("firmware"), emitted_folder(scene) as folder:
        program = build_firmware(folder, board, out)
    print_result(
        {"firmware": str(program), "board": board.name, "target": board.target},
        as_json,
        {"firmware": str(program)},
    )
