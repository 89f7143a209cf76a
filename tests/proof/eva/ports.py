"""The protocol and the links: any bytes, no invalid access."""

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from proof.eva.analysis import Analysis, Known, Precision, Question, alarms_in, answer

from springpot.runtime_c.paths import INCLUDE

PORTS = Path(__file__).with_name("ports")
_RUNTIME = INCLUDE.parent
_FOLDERS = (PORTS, *(_RUNTIME / "port" / part for part in ("wire", "posix", "mcu")), INCLUDE)
# A count of frames in one call does not wrap: at most 64 KiB are read, which joined states hide.
_OPTIONS = ("-eva-auto-loop-unroll", "64", "-no-warn-signed-overflow")

_PLAIN = Precision({}, (), {})


@dataclass(frozen=True)
class Port:
    """A driver in ports/, and what its analysis needs."""

    name: str
    precision: Precision
    options: tuple[str, ...] = ()


PORT_DRIVERS = (
    Port("wire",
         Precision({"decode_frame": 200, "sp_wire_receive": 400, "receive": 400},
                   ("decode_frame", "sp_wire_receive"), {}),
         ("-eva-min-loop-unroll", "64", "-eva-interprocedural-splits")),
    Port("serial",
         Precision({"take_frame": 400, "sp_wire_get_ack": 5, "sp_wire_get_sample": 5},
                   ("sp_wire_get_ack", "sp_wire_get_sample"), {}),
         ("-eva-interprocedural-splits",)),
    Port("odrive", _PLAIN), Port("dhd", _PLAIN),
)  # fmt: skip


def analyse_port(
    port: Port, folder: Path, timeout_s: float = 600.0, known: Known = MappingProxyType({})
) -> Analysis:
    """Analyse one of PORT_DRIVERS; Eva's log goes to a folder of its own in `folder`."""
    out = folder / f"port-{port.name}"
    out.mkdir(parents=True, exist_ok=True)
    named = " ".join(f"{name}(" for name in port.precision.apart)
    question = Question(
        out,
        PORTS / f"{port.name}.c",
        [path for part in _FOLDERS for path in part.glob("*.[ch]")],
        [f"-I{part}" for part in _FOLDERS],
        (*_OPTIONS, *port.options, *port.precision.options(named)),
        told=alarms_in,
    )
    return answer(question, known, timeout_s)
