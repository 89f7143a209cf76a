"""`springpot page`: press what was emitted, in a browser."""

from pathlib import Path

import click

from springpot.host.console.options import accept_edited_option
from springpot.host.console.output import json_option, print_result, progress_bar


@click.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="File.html to write.")
@accept_edited_option
@json_option
def page(folders: tuple[Path, ...], out: Path, accept_edited: bool, as_json: bool) -> None:
    """Write one HTML file in which people press the emitted FOLDERS, in a browser.

    The page runs the emitted C itself, as WebAssembly: needs clang and lld, or springpot[cc].
    Where node is installed, its forces are compared with those of this machine.
    """
    from springpot.host.page.press_page import check_module, write_press_page
    from springpot.host.wasm.wasm_node import missing_node

    with progress_bar("page"):
        entries = write_press_page(folders, out, accept_edited)
        checks = [
            check_module(folder, entry, accept_edited)
            for folder, entry in zip(folders, entries, strict=True)
        ]
    unmeasured = [entry["name"] for entry in entries if entry["recording"] is None]
    result = {
        "out": str(out),
        "bytes": out.stat().st_size,
        "scenes": [
            {**{key: entry[key] for key in ("name", "hash", "wasm_bytes")}, **check}
            for entry, check in zip(entries, checks, strict=True)
        ],
        "without_recording": unmeasured,
    }
    rows = {
        "page": str(out),
        "size": f"{out.stat().st_size / 1e3:.0f} kB, nothing else is needed: open it in a browser",
        "scenes": ", ".join(f"{entry['name']} ({entry['hash'][:12]})" for entry in entries),
    }
    if checks[0]["selftest"] is None:
        rows["not checked"] = f"whether its forces are those of this machine: {missing_node()}"
    if unmeasured:
        rows["no recording"] = (
            f"{', '.join(unmeasured)}: nothing measured to compare with: `springpot validate` first"
        )
    print_result(result, as_json, rows)
