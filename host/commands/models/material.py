"""`springpot material`: moduli, relaxation and a Prony series of a fitted springpot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot.codegen.errors import UsageError
from springpot.host.console.options import POSITIVE
from springpot.host.console.output import json_option, print_result

if TYPE_CHECKING:
    from springpot.trainer.models.material import Law


@click.command()
@click.argument("model", type=click.Path(path_type=Path))
@click.option("--tip-mm", type=POSITIVE, help="Diameter of the flat round tip.")
@click.option("--height-mm", type=POSITIVE, help="Height of the specimen; default: very high.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder for tables and a figure.")
@json_option
def material(
    model: Path, tip_mm: float | None, height_mm: float | None, out: Path | None, as_json: bool
) -> None:
    """Material of a MODEL of kind springpot: shear moduli need the tip's size, else stiffness."""
    from springpot.codegen.model.model_file import read_model
    from springpot.host.material.result import material_result, write_material
    from springpot.trainer.models.material import law_of, prony_of, shear_pa_per_npm

    if height_mm is not None and tip_mm is None:
        raise UsageError("--height-mm: give --tip-mm as well")
    fitted = read_model(model)
    law, prony = law_of(fitted), prony_of(fitted)
    scale = None
    if tip_mm is not None:
        scale = shear_pa_per_npm(1e-3 * tip_mm, None if height_mm is None else 1e-3 * height_mm)
    result = material_result(law, prony, scale)
    files = [] if out is None else write_material(out, law, prony, scale)
    print_result(result | {"files": files}, as_json, material_rows(result, law, out))


def material_rows(result: dict[str, Any], law: Law, out: Path | None) -> dict[str, str]:
    """A person's view."""
    widths = law.intervals
    rows = {
        "stiffness": f"{law.stiffness_npm:.5g} +- {widths['stiffness_npm']:.2g} N/m",
        "coefficient": f"{law.coefficient:.5g} +- {widths['coefficient']:.2g} N s^order/m",
        "order": f"{law.order:.4f} +- {widths['order']:.2g} (95 %)",
        "time": "no spring" if law.time_s is None else f"{law.time_s:.4g} s",
    }
    if "shear_modulus_pa" in result:
        rows["shear modulus"] = f"{result['shear_modulus_pa'] / 1e3:.4g} kPa (small depths)"
    losses = [f"{value:.3f} at {hz} Hz" for hz, value in result["loss_factor"].items()]
    rows["loss factor"] = ", ".join(losses)
    prony, (low_hz, *_, high_hz) = result["prony"], result["frequency_hz"]
    rows["Prony series"] = (
        f"{len(prony['tau_s'])} branches, within {100 * prony['max_error']:.2g} % of the law "
        f"from {low_hz:g} to {high_hz:g} Hz"
    )
    if out is not None:
        rows["written"] = str(out)
    return rows
