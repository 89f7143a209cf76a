"""What a reader of files is asked for, besides the path."""

from dataclasses import dataclass, field

from springpot.codegen.short_repr import short_repr
from springpot.trainer.recordings.formats.column_map import ColumnMap
from springpot.trainer.recordings.formats.csv.decimals import DecimalMark


@dataclass(frozen=True)
class FileRequest:
    """What a reader is asked for.

    columns: of each channel, "time", "position" or "force", the column or array and its unit; what
    it leaves out is guessed, and without --map it is empty. decimal: mark of decimals in text,
    None: guessed. resampled: samples are interpolated afterwards. place: headers of two columns,
    where the object is pressed.
    """

    columns: ColumnMap = field(default_factory=dict)
    decimal: DecimalMark | None = None
    resampled: bool = False
    place: tuple[str, str] | None = None
    __repr__ = short_repr
