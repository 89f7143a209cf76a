"""Notebooks, run cell by cell; `make notebook` stores what the quick start shows, for GitHub."""

import argparse
import ast
import base64
import contextlib
import io
import json
import os
import tempfile
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib import pyplot
from matplotlib.axes import Axes
from PIL import Image

from support.paths import ROOT

QUICK_START = ROOT / "examples" / "quick_start.ipynb"
Output = dict[str, Any]


def code_cells(notebook: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the cells that run."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run_cells(file: Path) -> tuple[dict[str, Any], list[list[Output]]]:
    """Run a notebook here; its names afterwards, and the outputs of each cell."""
    mpl.use("Agg")
    names: dict[str, Any] = {}
    return names, [_outputs("".join(cell["source"]), file.name, names)
                   for cell in code_cells(json.loads(file.read_text()))]  # fmt: skip


def _outputs(source: str, name: str, names: dict[str, Any]) -> list[Output]:
    """What Jupyter shows of a cell: what it prints, the value of its last line, open figures."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, name, "exec"), names)
        value = eval(compile(ast.Expression(last.value), name, "eval"), names) if last else None
    found: list[Output] = []
    if printed.getvalue():
        found.append({"output_type": "stream", "name": "stdout", "text": _lines(printed)})
    if value is not None and not isinstance(value, Axes):
        data = {"text/plain": _lines(repr(value))}
        found.append({"output_type": "execute_result", "data": data, "metadata": {}})
    for number in pyplot.get_fignums():
        drawn, png = io.BytesIO(), io.BytesIO()
        pyplot.figure(number).savefig(drawn, dpi=72)
        Image.open(drawn).quantize(32).save(png, format="png", optimize=True)  # a third the size
        data = {"image/png": base64.b64encode(png.getvalue()).decode()}
        found.append({"output_type": "display_data", "data": data, "metadata": {}})
    pyplot.close("all")
    return found


def _lines(text: str | io.StringIO) -> list[str]:
    whole = text if isinstance(text, str) else text.getvalue()
    return whole.splitlines(keepends=True)


def store_outputs(file: Path) -> None:
    """Run a notebook in an empty folder, and write what its cells show into it."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        _, outputs = run_cells(file)
    notebook = json.loads(file.read_text())
    for number, (cell, shown) in enumerate(zip(code_cells(notebook), outputs, strict=True), 1):
        results = [one for one in shown if one["output_type"] == "execute_result"]
        for result in results:
            result["execution_count"] = number
        cell.update(execution_count=number, outputs=shown)
    file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + os.linesep)


if __name__ == "__main__":
    argparse.ArgumentParser(description=store_outputs.__doc__).parse_args()
    store_outputs(QUICK_START)
