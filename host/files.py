"""Files from Python: recordings, models and scenes; paths are strings or Paths."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from springpot.codegen.errors import UsageError
from springpot.codegen.files import parse_path
from springpot.codegen.messages import notice
from springpot.codegen.model import model_file
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Scene
from springpot.host.emission import scene_file
from springpot.host.output import describe_os_error
from springpot.trainer.recordings import hdf5_file, recording_file
from springpot.trainer.recordings.formats.importing import ImportOptions
from springpot.trainer.recordings.recording import RECORDING_SUFFIX, Recording, Zero
from springpot.trainer.recordings.recording_file import Recordings, resolve_recordings

if TYPE_CHECKING:
    from springpot.trainer.models.fit import Fit

File = recording_file.File
write_scene = scene_file.write_scene


@contextmanager
def naming_unwritable_paths() -> Iterator[None]:
    """Raise UsageError, which is one line, where a file or folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise UsageError(describe_os_error(error)) from None


def read_recordings(*paths: File) -> list[Recording]:
    """Read files of recordings, and folders in the order of their files' names.

    Raises DataError naming the file that cannot be used.

    >>> len(read_recordings("training"))
    3
    """
    for path in paths:
        _require_file(path, "read_recordings(*paths) takes several")
    return recording_file.read_recordings(map(parse_path, paths))


def write_recordings(path: File, recordings: Recordings) -> list[Path]:
    """Write one recording to a file ending in .h5, or any number to a folder, NAME.h5 each.

    Returns the files that were written; a reader never sees half of one. Raises UsageError for
    several recordings in one file, or two of one name in a folder.

    >>> write_recordings("presses", press)[0].suffix
    '.h5'
    """
    out, chosen = parse_path(path), resolve_recordings(recordings)
    if out.suffix != RECORDING_SUFFIX:
        with naming_unwritable_paths():
            return write_in_folder(out, chosen)
    if len(chosen) != 1:
        raise UsageError(f"{out}: {len(chosen)} recordings for one file: give a folder")
    with naming_unwritable_paths():
        hdf5_file.write_recording(out, chosen[0])
    return [out]


def write_in_folder(
    folder: Path, recordings: Sequence[Recording], *, overwrite: bool = True
) -> list[Path]:
    """Write NAME.h5 of each recording, and return these files.

    Raises UsageError, and writes none, for two recordings of one name and, unless `overwrite`, for
    a file that is there.
    """
    files = [folder / f"{recording.name}{RECORDING_SUFFIX}" for recording in recordings]
    for number, file in enumerate(files):
        if file in files[:number]:
            sources = f"{recordings[files.index(file)].source} and {recordings[number].source}"
            raise UsageError(f"{file}: of {sources}: write recordings of one name to two folders")
        if file.exists() and not overwrite:
            raise UsageError(f"{file}: exists already: remove it or choose another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for file, recording in zip(files, recordings, strict=True):
        hdf5_file.write_recording(file, recording, overwrite=overwrite)
    return files


def import_recordings(
    paths: File | Sequence[File],
    columns: str = "",
    zero: Zero | None = "none",
    resample_hz: float | None = None,
    options: ImportOptions | None = None,
    rest_s: float | None = None,
) -> list[Recording]:
    """Read CSV, MAT and HDF5 files, journals, or folders of them, in SI units: one object's.

    Give all of them in one call, as to `springpot import`: their surface is found together.

    columns: such as "time=COL:s,position=COL:mm,force=COL:N", COL a header or a number from 1;
    where empty, guessed from the headers. How it was understood is logged.
    zero: subtract nothing, the "first" sample or the "min" of each channel, which the noise makes
    lower, so that what is left is higher by 3 to 4 times its standard deviation.
    resample_hz: rate, Hz, to interpolate at.
    options: delays, mass, tare, contact force.
    rest_s: the files are presses of one object in this order, so long apart, s.
    Raises DataError naming file and row, UsageError for columns and options that do not fit it.

    >>> import_recordings("press.csv", "time=t:s,position=x:mm,force=f:N")[0].name
    'press'
    """
    from springpot.host.quality import warn_of_quality
    from springpot.trainer.recordings.formats.column_map import parse_map
    from springpot.trainer.recordings.formats.importing import import_set

    files: Sequence[Any] = paths if isinstance(paths, list | tuple) else [paths]
    for file in files:
        _require_file(file, "or a list of files, and columns by springpot.Recording.from_frame")
    if not files:
        raise UsageError("no files: give at least one")
    mapping = parse_map(columns) if columns else None
    given = [parse_path(file) for file in files]
    recordings, guesses, notes = import_set(given, mapping, zero, resample_hz, options, rest_s)
    notice("\n".join([*guesses.values(), *notes]))
    return warn_of_quality(recordings).checked


def read_model(path: File) -> Model:
    """Read a model file. Raises DataError where it is damaged, of a later schema, or none.

    >>> read_model("model.spm").kind
    'hammerstein'
    """
    return model_file.read_model(parse_path(path))


def write_model(path: File, model: "Model | Fit") -> str:
    """Write a model to a file, by custom one ending in .spm, and return its hash.

    >>> write_model("model.spm", model) == write_model("again.spm", model)
    True
    """
    with naming_unwritable_paths():
        return model_file.write_model(parse_path(path), given_model(model))


def given_model(given: "Model | Fit | File") -> Model:
    """Return the model itself, that of a fit, or that of a file. Raises UsageError for no model."""
    from springpot.trainer.models.fit import Fit

    if isinstance(given, str | PathLike):
        return read_model(given)
    model = given.model if isinstance(given, Fit) else given
    if not isinstance(model, Model):
        raise UsageError(
            f"model: {type(given).__name__} is none: give a Model, a Fit or a file; "
            "springpot.from_ensemble makes a Model of a tree ensemble"
        )
    return model


def given_scene_and_model(
    scene: Scene | File | None, model: "Model | Fit | File | None"
) -> tuple[Scene, Model]:
    """Return both, each from the other where it is not given. Raises UsageError for neither."""
    stated = file = None
    if isinstance(scene, Scene):
        stated = scene_file.checked_scene(scene)
    elif scene is not None:
        file = parse_path(scene)
        stated = scene_file.read_scene(file)
    if model is None:
        if stated is None:
            raise UsageError("neither scene nor model: give --model or --scene, or both")
        model = stated.model if file is None else scene_file.model_path(stated, file)
    chosen = given_model(model)
    return stated or Scene(schema=1, name=chosen.name, model="model.spm"), chosen


def some_recordings(given: Recordings) -> list[Recording]:
    """Return the recordings themselves, or those of files. Raises UsageError for none."""
    if not (recordings := resolve_recordings(given)):
        raise UsageError("no recordings: give at least one")
    return recordings


def _require_file(path: object, several: str) -> None:
    if not isinstance(path, str | PathLike):
        raise UsageError(f"path: {type(path).__name__} is no file: give one, {several}")
