"""How files of each format begin, and their readers; registered in pyproject.toml."""

import re

from springpot.trainer.recordings.formats.file_format import FileFormat

_HDF5 = b"\x89HDF\r\n\x1a\n"
_MAT5, _MAT73 = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"  # the latter is HDF5 inside
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_HERE = "springpot.host.formats"


def is_can_log(start: bytes) -> bool:
    """Return if a file is a BLF log or begins with a line of candump's log format."""
    line = _text(start).split(b"\n")[0].decode("ascii", "replace").strip()
    candump = re.match(r"\(\d+\.\d+\)\s+\S+\s+[0-9A-Fa-f]{3,8}#", line)
    return start.startswith(b"LOGG") or candump is not None


def _text(start: bytes) -> bytes:
    return start.removeprefix(_BYTE_ORDER_MARK)


MACH1 = FileFormat(
    "Mach-1 text",
    lambda start: _text(start).startswith(b"<Mach-1 File>"), f"{_HERE}.mach1:read_mach1", 0,
)  # fmt: skip
CAN_LOG = FileFormat("CAN log", is_can_log, f"{_HERE}.can_log:read_can_log", 1)
HDF5 = FileFormat(
    "HDF5",
    lambda start: start.startswith((_HDF5, _MAT73)) or _HDF5 in start[512:],
    f"{_HERE}.arrays:read_hdf5_arrays", 2,
)  # fmt: skip
MAT = FileFormat(
    "MAT", lambda start: start.startswith(_MAT5), f"{_HERE}.arrays:read_mat_arrays", 3
)  # fmt: skip
TDMS = FileFormat(
    "TDMS", lambda start: start.startswith(b"TDSm"), f"{_HERE}.arrays:read_tdms_arrays", 4
)
WORKBOOK = FileFormat(
    "Excel workbook",
    lambda start: start.startswith(b"PK\x03\x04"), f"{_HERE}.workbook:read_workbook", 5,
)  # fmt: skip
