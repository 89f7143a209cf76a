"""Types of arrays and settings, and files that are whole or not there.

>>> from springpot.basics import write_file
>>> write_file(folder / "note.txt", b"42 presses")
>>> (folder / "note.txt").read_text()
'42 presses'
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.arrays import (
        Indices as Indices,
        Reals as Reals,
        Samples as Samples,
        given_numbers as given_numbers,
    )
    from springpot.codegen.atomic_write import (
        folder_written_aside as folder_written_aside,
        sync_folder as sync_folder,
        write_file as write_file,
        written_aside as written_aside,
    )
    from springpot.codegen.scene import Number as Number, Target as Target
    from springpot.codegen.short_repr import short_repr as short_repr
    from springpot.host.console.in_python import (
        errors_in_python as errors_in_python,
        in_python as in_python,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
