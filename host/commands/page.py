"""`springpot page`: press what was emitted, in a browser."""

from pathlib import Path

import click

from springpot.host.options import PATH
from springpot.host.output import json_option, print_result, progress_bar


@click.command()
@click.argument("folders", nargs=-1, required=True, type=PATH)
@click.option("--out", type=PATH, required=True, help="File.html to write.")
@json_option
def page(folders: tuple[Path, ...], out: Path, as_json: bool) -> None:
    """Write one HTML file in which people press the emitted FOLDERS, in a browser.

    The page runs the emitted C as WebAssembly: needs clang and lld, or springpot[cc].
    Where node is installed, its forces are compared with those of this machine.
    """
    from springpot.host.pages.press_page import write_press_page

    with progress_bar("page"):
        result = write_press_page(folders, out)
    unmeasured = result["without_recording"]
    rows = {"page": f"{out}, {result['bytes'] / 1e3:.0f} kB: open it in a browser"}
    rows["scenes"] = ", ".join(f"{one['name']} ({one['hash'][:12]})" for one in result["scenes"])
    if result["scenes"][0]["force_hash"] is None:
        rows["not checked"] = "its forces: no node on PATH (`apt-get install nodejs`)"
    if unmeasured:
        rows["no recording"] = f"{', '.join(unmeasured)}: `springpot validate` first to show one"
    print_result(result, as_json, rows)
