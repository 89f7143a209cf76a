"""CAN logs (BLF, candump) with a database of signals: position and force as signals of frames."""

import io
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError, UsageError
from springpot.host.devices.can import can_database
from springpot.host.formats.blf_containers import require_blf
from springpot.trainer.recordings.formats.column_map import Column, guess_column, stated_rate_hz
from springpot.trainer.recordings.formats.file_format import FileRequest
from springpot.trainer.recordings.formats.missing_samples import GAP_STEPS
from springpot.trainer.recordings.formats.raw_channels import RawChannels
from springpot.trainer.recordings.formats.units import Quantity, Unit, choose_unit

_CANDUMP = re.compile(
    r"\((?P<stamp>\d+\.\d+)\)\s+\S+\s+[0-9A-Fa-f]{3,8}#(R\d*|#[0-9A-Fa-f]([0-9A-Fa-f]{2}){0,64}"
    r"|([0-9A-Fa-f]{2}){0,8})( [TR])?"
)
_STAMP_DIGIT_S = 1e-6  # of both formats, as loggers write them


@dataclass
class _Signal:
    """Samples of one signal, in the database's unit, and the place of each in the file."""

    name: str
    unit: str
    stamps_s: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    places: list[int] = field(default_factory=list)


def read_can_log(path: Path, request: FileRequest) -> tuple[list[RawChannels], str]:
    """Read one recording; time is that of the frames with the position.

    The database, a DBC, KCD or ARXML file, names the signals and their units. Rates differ between
    frames: a force from other frames than the position is interpolated only if resampling was
    asked for.
    Raises UsageError without a database, DataError naming file and frame or row otherwise.
    """
    columns, database = request.columns, request.dbc
    if database is None:
        raise UsageError(f"{path}: a CAN log needs its database: pass --dbc FILE")
    if stated_rate_hz(columns) is not None:
        raise UsageError(f"{path}: frames carry time stamps: leave time out of --map")
    signals = _signals(path, database)
    position, force = (_choose(path, signals, q, columns.get(q)) for q in ("position", "force"))
    units = {
        "position": _unit(path, "position", position, columns.get("position")),
        "force": _unit(path, "force", force, columns.get("force")),
    }
    time_s = np.array(position.stamps_s) - position.stamps_s[0]
    position_m = np.array(position.values) * units["position"].to_si
    force_n = np.array(force.values) * units["force"].to_si
    found = ", ".join(
        f"{q} = signal {s.name!r} in {units[q].text} ({units[q].origin})"
        for q, s in (("position", position), ("force", force))
    )
    if force.stamps_s != position.stamps_s:
        if not request.resampled:
            raise DataError(
                f"{path}: {position.name} and {force.name} come in frames of different times: "
                "nothing is interpolated unasked, pass --resample-hz RATE"
            )
        force_s = np.array(force.stamps_s) - position.stamps_s[0]
        _check_gaps(path, force, force_s)
        inside = (time_s >= force_s[0]) & (time_s <= force_s[-1])
        force_n = np.interp(time_s[inside], force_s, force_n)
        time_s, position_m = time_s[inside], position_m[inside]
        found += f", force interpolated to the frames of the position ({inside.sum()} of them)"
    guess = f"CAN log with {database.name}: time = stamps of the frames, {found}"
    metadata = {q: unit.metadata() for q, unit in units.items()}
    raw = RawChannels(
        name=path.stem,
        time_s=time_s,
        position_m=position_m,
        force_n=force_n,
        time_digit_s=_STAMP_DIGIT_S,
        source=str(path),
        line_of=lambda sample: position.places[sample],
        details={"columns": guess, "units": {"time": {"unit": "s", "from": "log"}, **metadata}},
    )
    return [raw], guess


def _signals(path: Path, database: Path) -> dict[str, _Signal]:
    """Decode every frame that the database knows; other frames are not part of the recording."""
    known = can_database(database)
    signals: dict[str, _Signal] = {}
    unknown: dict[int, int] = defaultdict(int)
    for place, frame in _frames(path):
        if frame.is_error_frame or frame.is_remote_frame:
            continue
        try:
            message = known.get_message_by_frame_id(frame.arbitration_id)
        except KeyError:
            unknown[frame.arbitration_id] += 1
            continue
        try:
            decoded = message.decode(bytes(frame.data), decode_choices=False)
        except Exception as error:  # cantools and bitstruct raise many kinds
            raise DataError(
                f"{path}, row {place}: frame {frame.arbitration_id:#x} is no {message.name} of the "
                f"database ({error}): correct the log or --dbc"
            ) from None
        for signal in message.signals:
            if signal.name in decoded:
                full = f"{message.name}.{signal.name}"
                series = signals.setdefault(full, _Signal(full, signal.unit or ""))
                series.stamps_s.append(float(frame.timestamp))
                series.values.append(float(decoded[signal.name]))
                series.places.append(place)
    if not signals:
        ids = ", ".join(f"{number:#x}" for number in list(unknown)[:8])
        raise DataError(f"{path}: {database.name} knows none of its frames ({ids}): correct --dbc")
    return signals


def _frames(path: Path) -> Iterator[tuple[int, Any]]:
    """Yield each frame with its row (candump) or number (BLF), from 1."""
    with path.open("rb") as file:
        is_blf = file.read(4) == b"LOGG"
    yield from (_blf(path) if is_blf else _candump(path))


def _candump(path: Path) -> Iterator[tuple[int, Any]]:
    import can

    with path.open(encoding="ascii", errors="replace") as file:
        for row, line in enumerate(file, 1):
            if not line.strip():
                continue
            if not _CANDUMP.fullmatch(line.strip()):
                raise DataError(
                    f"{path}, row {row}: {line.strip()[:60]!r} is no line of a candump log: "
                    "correct or cut it in the source"
                )
            for frame in can.CanutilsLogReader(io.StringIO(line)):
                yield row, frame


def _blf(path: Path) -> Iterator[tuple[int, Any]]:
    import can

    require_blf(path)
    number = 0
    try:
        with path.open("rb") as file, can.BLFReader(file) as reader:
            if reader.file_size > path.stat().st_size:
                raise DataError(
                    f"{path}: cut short, {path.stat().st_size} of {reader.file_size} bytes: copy "
                    "it again"
                )
            for frame in reader:
                number += 1
                yield number, frame
    except DataError:
        raise
    except Exception as error:  # zlib, struct and the reader's own
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:150]
        raise DataError(
            f"{path}, row {number + 1}: damaged after {number} frames ({reason}): copy it again"
        ) from None


def _choose(
    path: Path, signals: dict[str, _Signal], quantity: Quantity, column: Column | None
) -> _Signal:
    names = list(signals)
    if column is not None:
        options = str(column.header_or_number)
        found = [n for n in names if options in (n, n.partition(".")[2])]
    else:
        labels = [n.partition(".")[2] for n in names]
        found = [names[index] for index in guess_column(labels, quantity)]
    if len(found) != 1:
        what = f"may be {', '.join(found)}" if found else "is none of its signals"
        raise DataError(
            f"{path}: {quantity} {what}; it holds {', '.join(names[:12])}: pass "
            f"--map {quantity}=Message.Signal"
        )
    return signals[found[0]]


def _unit(path: Path, quantity: Quantity, signal: _Signal, column: Column | None) -> Unit:
    found = {"map": column.unit if column else None, "database": signal.unit}
    return choose_unit(found, quantity, f"{path}, signal {signal.name}", signal.name)


def _check_gaps(path: Path, signal: _Signal, stamps_s: Samples) -> None:
    steps_s = np.diff(stamps_s)
    bad = np.flatnonzero((steps_s <= 0.0) | (steps_s > GAP_STEPS * np.median(steps_s)))
    if len(bad):
        raise DataError(
            f"{path}, row {signal.places[bad[0] + 1]}: {signal.name} comes {steps_s[bad[0]]:.6g} s "
            f"after the one before, {np.median(steps_s):.6g} s is usual ({len(bad)} such frames): "
            "cut the log there"
        )
