"""Metadata beside the samples of recordings and journals, checked before anything uses it."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from annotated_types import Gt
from pydantic import TypeAdapter, ValidationError

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError
from springpot.trainer.recordings.recording import Recording, Zero, require_recording_name

RECORDING_SCHEMA = 1
_Seconds = Annotated[float, Gt(0)]


@dataclass(frozen=True)
class RecordingMetadata:
    """As the fields of `Recording`.

    channels: names of those beside position and force in a journal's rows.
    """

    __pydantic_config__ = {"allow_inf_nan": False}  # noqa: RUF012, the name that pydantic asks for
    schema: int
    name: str
    dt_s: _Seconds
    source: str
    details: dict[str, Any]
    zero: Zero = "none"
    position_delay_s: float = 0.0
    force_delay_s: float = 0.0
    channels: tuple[str, ...] = ()
    session: str = ""
    start_s: float | None = None
    place_x_m: float | None = None
    place_y_m: float | None = None

    def recording(
        self, where: str, position_m: Samples, force_n: Samples, channels: Mapping[str, Samples]
    ) -> Recording:
        """The recording of these samples. Raises DataError, which begins with `where`."""
        try:
            return Recording(
                name=self.name,
                position_m=position_m,
                force_n=force_n,
                dt_s=self.dt_s,
                zero=self.zero,
                position_delay_s=self.position_delay_s,
                force_delay_s=self.force_delay_s,
                source=self.source,
                details=self.details,
                channels=channels,
                session=self.session,
                start_s=self.start_s,
                place_x_m=self.place_x_m,
                place_y_m=self.place_y_m,
            )
        except DataError as error:
            raise DataError(f"{where}: {error}") from None


_ADAPTER = TypeAdapter(RecordingMetadata)


def metadata_of_json(where: str, text: str | bytes) -> dict[str, Any]:
    """Parse a table of JSON. Raises DataError, which begins with `where`, for anything else."""
    try:
        found = json.loads(text)
    except (ValueError, TypeError, RecursionError) as error:
        found = error
    if not isinstance(found, dict):
        raise DataError(
            f"{where}: not a springpot recording (its metadata is no table in JSON, but "
            f"{str(found)[:60]!r}): make one with `springpot import`"
        )
    return found


def checked_metadata(
    where: str, values: Mapping[str, Any], required: Iterable[str] = ()
) -> RecordingMetadata:
    """Metadata with every field of its type. Raises DataError, which begins with `where`.

    required: fields that have to be there although they have a default.
    """
    schema = values.get("schema")
    if isinstance(schema, int) and schema > RECORDING_SCHEMA:
        raise DataError(
            f"{where}: recording schema {schema}, this springpot reads up to {RECORDING_SCHEMA}: "
            "upgrade springpot"
        )
    if missing := [name for name in required if name not in values]:
        raise DataError(
            f"{where}: not a springpot recording (its {missing[0]} is missing): make one with "
            "`springpot import`"
        )
    try:
        found = _ADAPTER.validate_python(values)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        told = "" if first["type"] == "missing" else f" (found {str(first['input'])[:60]!r})"
        raise DataError(
            f"{where}: not a springpot recording (its {key}: {first['msg']}{told}): make one with "
            "`springpot import`"
        ) from None
    require_recording_name(found.name, f"{where}: ")
    return found
