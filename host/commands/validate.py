"""`springpot validate`: replay recordings through the C."""

from pathlib import Path

import click

from springpot.codegen.messages import counted_noun
from springpot.host.options import PATH, recordings_given
from springpot.host.output import json_option, print_line, print_result, progress_bar


@click.command(name="validate")
@click.argument("folder", type=PATH)
@recordings_given
@json_option
def validate_(folder: Path, recordings: tuple[str, ...], as_json: bool) -> None:
    """Replay recordings (files or folders) through the C of an emitted FOLDER."""
    from springpot.host.emission.emission import require_emission
    from springpot.host.validation.store import store_validation, summary_rows
    from springpot.host.validation.validation import raise_on_mismatch, validate
    from springpot.trainer.recordings.recording_file import read_recordings

    require_emission(folder)  # first: where both are given the wrong way round, it says so
    read = read_recordings(map(Path, recordings))
    with progress_bar(f"{counted_noun(len(read), 'recording')}"):
        validation = validate(folder, read)
    if len(validation.felt) < len(read):  # a log says nothing of the object: the page needs that
        try:
            store_validation(folder, validation)
        except OSError as error:
            print_line(
                f"warning: {error.filename}: {error.strerror}: this validation is not stored for "
                f"`springpot report`: copy {folder} to where it can be written, and validate there"
            )
    print_result(validation.as_dict(), as_json, summary_rows(validation))
    raise_on_mismatch(folder, validation)
