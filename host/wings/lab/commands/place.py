"""The command `springpot place`: where the object's surface is."""

import json
import sys
from pathlib import Path

import click

from springpot.console import json_option, say


@click.command()
@click.option("--device", "url", required=True, help="Such as dhd:// or serial:///dev/ttyACM0.")
@click.option(
    "--scene",
    type=click.Path(path_type=Path),
    help="Read its [device], and write surface_mm into it.",
)
@json_option
def place(url: str, scene: Path | None, as_json: bool) -> None:
    """Find the surface: touch it with the tool three times, the Enter key each time.

    The device gives no force meanwhile.
    """
    from springpot import Device, UsageError, read_scene
    from springpot.console import stopping_on_sigterm
    from springpot.devices import driver_of, parse_device
    from springpot.host.wings.lab.identification.keys import require_writable_device, write_keys
    from springpot.host.wings.lab.identification.touch import TOUCHES, find_surface

    keys = Device()
    if driver_of(url).virtual:
        raise UsageError(f"{url}: its surface is at 0: give a device that is touched")
    if "surface_mm" in parse_device(url).settings:
        raise UsageError(f"{url}: leave surface_mm out of the URL: it is what is sought")
    if scene is not None:
        keys = read_scene(scene).device
        require_writable_device(scene)

    def touched(number: int) -> None:
        say(f"touch {number} of {TOUCHES}: put the tool on the surface, keep it still, press Enter")
        if not sys.stdin.readline():
            raise UsageError("nobody presses Enter: run it in a terminal")

    with stopping_on_sigterm():
        surface = find_surface(url, keys, touched)
    surface_mm = round(1e3 * surface.surface_m, 3)
    if scene is not None:
        write_keys(scene, {"surface_mm": surface_mm})
    if as_json:
        click.echo(
            json.dumps({"surface_mm": surface_mm, "spread_mm": round(1e3 * surface.spread_m, 3)})
        )
        return
    click.echo(f"surface_mm = {surface_mm:g}  # touches within {1e3 * surface.spread_m:.2f} mm")
    if scene is not None:
        click.echo(f"written to {scene}")
