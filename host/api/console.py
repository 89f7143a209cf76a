"""Commands: their options, tables, progress, keys and settings files.

>>> from springpot.console import checked_keys, print_result
>>> print_result({"presses": 3}, False, {"presses": "3"})
presses  3
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.entry_points import part as part
    from springpot.codegen.progress import counted as counted
    from springpot.host.commands.recordings.check import check_parts as check_parts
    from springpot.host.commands.scenes.emit import emission_rows as emission_rows
    from springpot.host.commands.scenes.stability import stability_rows as stability_rows
    from springpot.host.commands.scenes.validate import validation_rows as validation_rows
    from springpot.host.console.keys import reading_keys as reading_keys
    from springpot.host.console.lazy_group import LazyCommand as LazyCommand, LazyGroup as LazyGroup
    from springpot.host.console.options import (
        SEED as SEED,
        accept_edited_option as accept_edited_option,
        recordings_given as recordings_given,
    )
    from springpot.host.console.output import (
        json_option as json_option,
        print_json as print_json,
        print_result as print_result,
        print_table as print_table,
        progress_bar as progress_bar,
        progress_console as progress_console,
        say as say,
    )
    from springpot.host.console.quality import report_quality as report_quality
    from springpot.host.console.toml_file import (
        checked_keys as checked_keys,
        toml_as_json as toml_as_json,
    )
    from springpot.host.session.terminal import stopping_on_sigterm as stopping_on_sigterm
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
