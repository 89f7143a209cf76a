"""A recording: position and force of one press or one session, uniformly sampled, in SI units."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import dist
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np

from springpot.codegen.arrays import Samples, to_readonly_float64
from springpot.codegen.errors import DataError, UsageError
from springpot.codegen.messages import counted_noun

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Zero = Literal["none", "first", "min"]
Site = tuple[float, float]  # x and y, m

RECORDING_SUFFIX = ".h5"
SAME_PLACE_M = 1e-4  # no printed grid and no stage is finer
FRAME_SOURCE = "frame"  # source of the columns of a table
MAX_NAME_BYTES = 200  # a file name has 255: room for endings
# On Windows files of these names, whatever their ending, are devices.
_WINDOWS_DEVICES = {"con", "prn", "aux", "nul"} | {
    f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)
}
_UNSAFE_CHARACTERS = re.compile(r"[^\w.+-]+")
_FROM_FRAME = "springpot.trainer.recordings.formats.importing:recording_from_frame"
_MAX_SPAN_M = 1.0  # no soft object is pressed farther
SIGN_RULE = (
    "position: penetration from the undeformed surface, positive into the object; "
    "force: positive pushes the tool out of the object"
)


@dataclass(frozen=True, eq=False)
class Recording:
    """Uniform samples of position and force.

    name: also a file name, see `require_recording_name`.
    position_m, force_n: shape (n,), finite, lists too; kept as float64, in copies that cannot
    be written to; signs as in `SIGN_RULE`.
    dt_s: time between samples.
    zero: what the importer subtracted from both channels; "none", None: position 0 is the surface.
    position_delay_s, force_delay_s: how much later than the truth each channel was sampled.
    source: where the samples came from, for people (file and block, or device).
    details: further metadata of the source, for people and reports; JSON values.
    channels: more samples beside the two, each (n,); of a session what each tick was given and
    returned. A fit does not see them.
    session: the same word in recordings of one object, one after another; "" if that is not known.
    start_s: time of the first sample on the clock that they share; None if it is not known.
    place_x_m, place_y_m: where on its surface the object was pressed; None if that is not known.

    Raises DataError where the channels cannot be a recording, or the name no file's, and where
    positions without a source span more than 1 m, as millimetres do; UsageError for another zero.

    >>> Recording("pad", [0.0, 1e-3, 2e-3], [0.0, 0.4, 0.9], dt_s=1e-3)
    Recording('pad', 3 samples at 1000 Hz, 0 to 2 mm, 0 to 0.9 N)
    """

    name: str
    position_m: Samples
    force_n: Samples
    dt_s: float
    zero: Zero = "none"
    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    source: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)
    channels: Mapping[str, Samples] = field(default_factory=dict)
    session: str = ""
    start_s: float | None = None
    place_x_m: float | None = None
    place_y_m: float | None = None

    def __repr__(self) -> str:
        return (
            f"Recording({self.name!r}, {len(self.force_n)} samples at {1.0 / self.dt_s:.6g} Hz, "
            f"{1e3 * self.position_m.min():.4g} to {1e3 * self.position_m.max():.4g} mm, "
            f"{self.force_n.min():.4g} to {self.force_n.max():.4g} N)"
        )

    def __post_init__(self) -> None:
        """Refuse what is no recording: shapes, numbers, names, and positions that are in mm."""
        require_recording_name(self.name)
        object.__setattr__(self, "zero", parse_zero(self.zero))
        object.__setattr__(self, "dt_s", _to_time_step_s(self.name, self.dt_s))
        for channel in ("position_m", "force_n"):
            object.__setattr__(self, channel, to_readonly_float64(getattr(self, channel), channel))
        channels = {"position": self.position_m, "force": self.force_n, **self.channels}
        for channel, samples in channels.items():
            if samples.ndim != 1 or samples.shape != self.position_m.shape:
                raise DataError(
                    f"{self.name}: {channel} has {samples.shape} samples and position "
                    f"{self.position_m.shape}: give 1-D channels of one length"
                )
        if len(self.position_m) < 2:
            raise DataError(f"{self.name}: {len(self.position_m)} rows: a recording needs two")
        place = (self.place_x_m, self.place_y_m)
        if place != (None, None) and not all(at is not None and abs(at) <= 1.0 for at in place):
            raise DataError(
                f"{self.name}: place_x_m, place_y_m = {place[0]}, {place[1]}: give both, from -1 "
                "to 1 m, or neither"
            )
        for channel in ("position", "force"):
            bad = np.flatnonzero(~np.isfinite(channels[channel]))
            if len(bad):
                raise DataError(
                    f"{self.name}: {channel} is not finite at row {bad[0]} "
                    f"({counted_noun(len(bad), 'row')} in all): "
                    "cut or repair those rows in the source"
                )
        # Without the outermost hundredths: a spike is held, not refused.
        travel_m = np.ptp(np.quantile(self.position_m, (0.01, 0.99), method="nearest"))
        if travel_m > _MAX_SPAN_M and self.source in ("", FRAME_SOURCE):
            raise DataError(
                f"{self.name}: position_m spans {travel_m:.4g} m: are these mm? give positions in "
                "metres"
            )

    @classmethod
    def from_frame(cls, frame: Any, name: str = FRAME_SOURCE, **options: Any) -> "Recording":
        """Take three columns of a table of pandas or polars, or of anything else with names.

        options: time, position, force: columns, else time_s, position_m and force_n, with the unit
        in the name ("Load [N]", "x_mm") or behind a colon ("x:mm"), in letters of either case;
        stamps of date or duration need no unit. time may also be a rate, "1000Hz". zero,
        resample_hz, conditioning: as for `import_recordings`; a table with a tool that starts in
        the air takes Conditioning(contact_force="auto"). Columns place_x and place_y, with a unit
        of length, say where the object was pressed.
        Raises UsageError for an argument that is no table and for a missing column, DataError for a
        unit that is missing, unknown or not the name's, and for data that no import would take.

        >>> Recording.from_frame({"x_mm": [0, 1, 2], "F": [0, 4, 9]}, time="1kHz", position="x_mm",
        ...                      force="F:N")
        Recording('frame', 3 samples at 1000 Hz, 0 to 2 mm, 0 to 9 N)
        """
        # By name, as kinds are: the reader of tables makes recordings, and imports this file.
        return cast(Recording, resolve_name(_FROM_FRAME)(frame, name, **options))

    def to_frame(self) -> Any:
        """Make a pandas table of time_s, position_m, force_n, the place and further channels.

        `from_frame` reads all but the further channels from it.
        """
        try:
            from pandas import DataFrame
        except ModuleNotFoundError:
            raise UsageError("to_frame needs pandas: pip install pandas") from None
        time_s = self.dt_s * np.arange(len(self.force_n))
        columns = {"time_s": time_s, "position_m": self.position_m, "force_n": self.force_n}
        place = {"place_x_m": self.place_x_m, "place_y_m": self.place_y_m} if self.place_m else {}
        return DataFrame({**self.channels, **columns, **place})

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw force against position on matplotlib's axes, on new ones if none are given.

        Return the axes. Raises UsageError where matplotlib is not installed.
        """
        axes = axes_for_plot(ax)
        axes.plot(1e3 * self.position_m, self.force_n, lw=0.8, label=self.name)
        axes.set(xlabel="position, mm", ylabel="force, N")
        axes.legend(loc="upper left", frameon=False)
        return axes

    @property
    def signs_accepted(self) -> bool:
        """Return whether a person stated on import that the signs are right."""
        return self.details.get("accepted_signs") is True

    @property
    def place_m(self) -> tuple[float, float] | None:
        """Return x and y of the place that was pressed, m; None if that is not known."""
        if self.place_x_m is None or self.place_y_m is None:
            return None
        return self.place_x_m, self.place_y_m

    @property
    def rate_hz(self) -> float:
        return 1.0 / self.dt_s

    @property
    def duration_s(self) -> float:
        """Time from the first sample to one step after the last."""
        return len(self.position_m) * self.dt_s

    @property
    def content_hash(self) -> str:
        """SHA-256 of all that a fit can see: both channels, the time step and the place."""
        digest = hashlib.sha256()
        place = () if self.place_m is None else (np.array(self.place_m),)
        for values in (np.float64(self.dt_s), self.position_m, self.force_n, *place):
            digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
        return digest.hexdigest()


def _to_time_step_s(name: str, dt_s: Any) -> float:
    number = isinstance(dt_s, int | float | np.number) and not isinstance(dt_s, bool)
    if not number or not (np.isfinite(dt_s) and dt_s > 0.0):
        raise DataError(f"{name}: dt_s={dt_s!r} is not a time step: give seconds, above 0")
    return float(dt_s)


def parse_zero(given: Any) -> Zero:
    """Return one of the words of `Zero`; None is "none". Raises UsageError for anything else."""
    if given is None:
        return "none"
    words = get_args(Zero)
    if isinstance(given, str) and given in words:
        return cast(Zero, given)
    raise UsageError(
        f"zero={repr(given)[:60]}: give {', '.join(map(repr, words[:-1]))} or {words[-1]!r}"
    )


def require_recording_name(name: Any) -> None:
    """Raise DataError for a name that could lead out of a folder, or could not be printed."""
    if not isinstance(name, str):
        raise DataError(f"name={name!r}: a recording's name is text: give a str")
    fits = (
        0 < len(name.encode("utf-8", "replace")) <= MAX_NAME_BYTES
        and name.isprintable()  # neither newlines nor bytes that are no text
        and not name.startswith(".")
        and not set(name) & set('/\\:*?"<>|')
        and name.partition(".")[0].lower() not in _WINDOWS_DEVICES
    )
    if not fits:
        raise DataError(
            f"a recording named {name[:60]!a}: a name is printable, without "
            '/ \\ : * ? " < > |, no device of Windows (aux, nul, com1), '
            f"begins with no dot and has 1 to {MAX_NAME_BYTES} bytes: name it otherwise"
        )


def safe_recording_name(text: str) -> str:
    """Return a name that `require_recording_name` accepts, as near to the text as can be."""
    safe = _UNSAFE_CHARACTERS.sub("_", text).strip("._")
    if safe.partition(".")[0].lower() in _WINDOWS_DEVICES:
        safe = f"_{safe}"
    return safe.encode()[: MAX_NAME_BYTES - 20].decode("utf-8", "ignore") or "recording"


def group_by_site(recordings: Sequence[Recording]) -> dict[Site, list[int]]:
    """Numbers of the recordings of each site, in the order of recording.

    Recordings without a place are of no site.
    """
    sites: dict[Site, list[int]] = {}
    for number, recording in enumerate(recordings):
        if recording.place_m is not None:
            here = recording.place_m
            known = next((site for site in sites if dist(site, here) < SAME_PLACE_M), here)
            sites.setdefault(known, []).append(number)
    return sites


def format_site(site: Site) -> str:
    """Write a site as messages show it, in mm."""
    return f"({1e3 * site[0]:.4g}, {1e3 * site[1]:.4g}) mm"


def axes_for_plot(axes: "Axes | None") -> "Axes":
    """Return these axes, or those of a new figure of pyplot where none are given.

    Raises UsageError where matplotlib is not installed.
    """
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ModuleNotFoundError:
        raise UsageError(".plot() needs matplotlib: pip install 'springpot[report]'") from None
    return pyplot.subplots(layout="constrained")[1]
