"""`springpot material`: moduli, relaxation and a Prony series of a fitted springpot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from springpot.console import PERCENT, POSITIVE, json_option, print_result

if TYPE_CHECKING:
    from springpot.host.wings.material.law.geometry import Shape
    from springpot.host.wings.material.law.material import Law


@click.command()
@click.argument("model", type=click.Path(path_type=Path))
@click.option(
    "--geometry",
    type=click.Choice(["flat", "sphere", "cone", "plates", "bonded-plates"]),
    default="flat",
    help="Shape of the tip, or plates, which slide on the specimen or are bonded; default flat.",
)
@click.option(
    "--tip-mm", type=POSITIVE, help="Diameter of the tip; between plates, the specimen's."
)
@click.option("--height-mm", type=POSITIVE, help="Height of the specimen; default: very high.")
@click.option("--depth-mm", type=POSITIVE, help="Mean depth of a sphere or cone.")
@click.option("--cone-deg", type=POSITIVE, help="Angle of a cone, from axis to side.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder for tables and a figure.")
@click.option(
    "--prony-error",
    type=PERCENT,
    default=0.05,
    metavar="P%",
    help="What the Prony series may miss; default 5%.",
)
@click.option(
    "--accept-unidentified",
    is_flag=True,
    help="Quote moduli, and write a marked figure, of a law that the recordings do not show.",
)
@json_option
def material(
    model: Path,
    geometry: Shape,
    tip_mm: float | None,
    height_mm: float | None,
    depth_mm: float | None,
    cone_deg: float | None,
    out: Path | None,
    prony_error: float,
    accept_unidentified: bool,
    as_json: bool,
) -> None:
    """Material of a MODEL of kind springpot: shear moduli need the tip's size, else stiffness."""
    from springpot import read_model
    from springpot.host.wings.material.law.geometry import Geometry
    from springpot.host.wings.material.law.material import law_of, prony_of
    from springpot.host.wings.material.result import (
        material_result,
        require_identified,
        require_prony,
        write_material,
    )

    sizes = (tip_mm, height_mm, depth_mm, cone_deg)
    fitted = read_model(model)
    law, prony = law_of(fitted), prony_of(fitted)
    scale, pressed = None, "give the sizes of tip and specimen, see `springpot material --help`"
    if geometry != "flat" or any(size is not None for size in sizes):
        of = Geometry(geometry, *sizes)
        scale, pressed = of.shear_pa_per_npm, of.words
        of.require_plausible(fitted.trained.max_m - fitted.trained.min_m)
    result = material_result(law, prony, scale, accept_unidentified)
    if out is not None and not accept_unidentified:
        require_identified(law)
    require_prony(result, prony_error)
    files = [] if out is None else write_material(out, law, prony, scale)
    print_result(result | {"files": files}, as_json, material_rows(result, law, out, pressed))


def material_rows(
    result: dict[str, Any], law: Law, out: Path | None, pressed: str
) -> dict[str, str]:
    """Return a person's view. pressed: what the modulus is taken from, or how to get one."""
    rows = {
        "stiffness": _quoted(law, "stiffness_npm", "N/m, at rest"),
        "coefficient": _quoted(law, "coefficient", "N s^order/m"),
        "order": _quoted(law, "order", ""),
        "time": "no spring" if law.time_s is None else f"{law.time_s:.4g} s",
    }
    if law.instant_npm is not None:
        rows["instant stiffness"] = _quoted(law, "instant_npm", "N/m")
    if "shear_modulus_pa" in result:
        width_pa = result["shear_modulus_interval_pa"]
        width = "" if width_pa is None else f" +- {width_pa / 1e3:.2g}"
        sure = "not identified" if width_pa is None else "95 %"
        rows["shear modulus"] = (
            f"{result['shear_modulus_pa'] / 1e3:.4g}{width} kPa ({sure}; small depths; {pressed})"
        )
    elif result["unit"] != "pa":
        rows["shear modulus"] = pressed
    if law.residual_percent is not None:
        rows["missed"] = f"{law.residual_percent:.3g} % of the force that varies, rms"
    low_hz, high_hz = law.covered_hz or (0.0, float("inf"))
    losses = [
        f"{value:.3f} at {hz} Hz{'' if low_hz <= float(hz) <= high_hz else ' (extrapolated)'}"
        for hz, value in result["loss_factor"].items()
    ]
    rows["loss factor"] = ", ".join(losses)
    if law.measured:
        rows["  measured"] = ", ".join(
            f"{point['loss_npm'] / point['storage_npm']:.3f} at {point['frequency_hz']:.3g} Hz"
            for point in law.measured
        )
    prony = result["prony"]
    rows["Prony series"] = (
        f"{len(prony['tau_s'])} branches, within {100 * prony['max_error']:.2g} % of the law "
        + (f"from {low_hz:.2g} to {high_hz:.2g} Hz" if law.covered_hz else "")
    )
    if out is not None:
        rows["written"] = str(out)
    return rows


def _quoted(law: Law, name: str, unit: str) -> str:
    value, width = getattr(law, name), law.intervals[name]
    if width is None:
        return f"{value:.3g} {unit}: not identified, {law.not_identified[name]}"
    return f"{value:.5g} +- {width:.2g} {unit} (95 %)"
