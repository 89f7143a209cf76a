"""springpot in Python: recordings in, a fitted model, C that renders it, and what a hand feels.

    import springpot

Nothing is loaded before it is used. Arrays are numpy's, in SI units: position in m, the penetration
from the undeformed surface, positive into the object; force in N, positive where it pushes the tool
out. Every refusal is a `SpringpotError` of one line: what, where, what to do.
docs/reference/python.md lists everything.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from springpot.codegen.errors import (
        SpringpotError as SpringpotError,
    )
    from springpot.codegen.model.features import (
        Features as Features,
    )
    from springpot.codegen.model.model import (
        Model as Model,
    )
    from springpot.codegen.scene import (
        Scene as Scene,
    )
    from springpot.host.emission.scene_file import (
        read_scene as read_scene,
    )
    from springpot.host.ensemble import (
        from_ensemble as from_ensemble,
    )
    from springpot.host.files import (
        import_recordings as import_recordings,
        read_model as read_model,
        read_recordings as read_recordings,
        write_model as write_model,
        write_recordings as write_recordings,
    )
    from springpot.host.loaded import (
        load as load,
    )
    from springpot.host.session.session import (
        Session as Session,
    )
    from springpot.host.steps import (
        bench as bench,
        emit as emit,
        predict as predict,
        record as record,
        stability as stability,
        train as train,
    )
    from springpot.host.validation.validation import (
        validate as validate,
    )
    from springpot.trainer.models.fit import (
        Fit as Fit,
    )
    from springpot.trainer.recordings.quality.report import (
        check_recordings as check_recordings,
    )
    from springpot.trainer.recordings.recording import (
        Recording as Recording,
    )

_STEPS = "host.steps"
_FILES = "host.files"
_MODULES = {
    "Recording": "trainer.recordings.recording",
    "import_recordings": _FILES,
    "read_recordings": _FILES,
    "write_recordings": _FILES,
    "check_recordings": "trainer.recordings.quality.report",
    "record": _STEPS,
    "train": _STEPS,
    "Fit": "trainer.models.fit",
    "Model": "codegen.model.model",
    "read_model": _FILES,
    "write_model": _FILES,
    "Features": "codegen.model.features",
    "from_ensemble": "host.ensemble",
    "predict": _STEPS,
    "Scene": "codegen.scene",
    "read_scene": "host.emission.scene_file",
    "emit": _STEPS,
    "load": "host.loaded",
    "validate": "host.validation.validation",
    "stability": _STEPS,
    "bench": _STEPS,
    "Session": "host.session.session",
    "SpringpotError": "codegen.errors",
}
__all__ = [  # noqa: PLE0604 (in the order of a job; __getattr__ has them)
    *_MODULES
]


def __getattr__(name: str) -> object:
    """Import a name when it is first used."""
    if name == "__version__":
        from importlib.metadata import version

        return version("springpot")
    if name not in _MODULES:
        raise AttributeError(f"module 'springpot' has no attribute {name!r}: see dir(springpot)")
    from springpot.codegen.errors import naming_missing_packages

    with naming_missing_packages():
        found: object = getattr(import_module(f"springpot.{_MODULES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return list(_MODULES)
