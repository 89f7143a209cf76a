"""Scene files: TOML, then the plan of a small model in such a scene."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from proof.fuzz.reader import Reader
from support.small import scene, small_model

from springpot.codegen.errors import SpringpotError, UsageError
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Budget, Coupling, Device, Guard, Runtime, Smoothing
from springpot.host.emission.scene_file import read_scene, write_scene


def seeds() -> Iterator[tuple[str, bytes]]:
    """Scenes with few keys, with many, and the same by hand."""
    plain = scene()
    full = replace(
        plain,
        runtime=Runtime(rate_hz=2000, number="float64", prefix="eco"),
        coupling=Coupling(mode="proxy"),
        smoothing=Smoothing(time_constant_s=0.001),
        guard=Guard(max_force_n=12.0, watchdog_ms=20.0, outside="hold", contact="always"),
        device=Device(delay_samples=2, m_per_turn=0.1, sign=-1, max_torque_nm=1.0),
        budget=Budget(flash_bytes=65536, ram_bytes=8192, tick_us=100.0),
    )
    with TemporaryDirectory() as folder:
        for name, made in {"plain": plain, "full": full}.items():
            write_scene(Path(folder) / name, made)
            yield name, (Path(folder) / name).read_bytes()
    yield "inline", b'schema = 1\nname = "a"\nmodel = \'m\'\ncoupling = {mode = "tool"}\n'


def read(content: bytes, folder: Path) -> None:
    """Read the scene; plan the emission of a small model in it."""
    file = folder / "scene.toml"
    file.write_bytes(content)
    found = read_scene(file)
    try:
        make_plan(small_model(), found)
    except SpringpotError as error:  # names the key, not the file
        raise UsageError(f"{file}: {error}") from None


READER = Reader(
    seeds,
    read,
    words=(
        "schema = 1", "[runtime]", "[coupling]", "[smoothing]", "[guard]", "[device]", "[budget]",
        "rate_hz = ", "number = ", "prefix = ", "forest = ", "mode = ", "time_constant_s = ",
        "max_force_n = ", "watchdog_ms = ", "outside = ", "contact = ", "onset_mm = ", "inf", "nan",
        "-1", "1e308", "1e-308", '"""', "'''", "1979-05-27", "[[", "{a = 1}", "\\u0000", "0x7f",
    ),
)  # fmt: skip
