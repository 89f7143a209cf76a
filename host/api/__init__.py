"""springpot in Python: recordings in, a fitted model, C that renders it, and what a hand feels.

    import springpot

Nothing is loaded before it is used. Arrays are numpy's, in SI units: position in m, the penetration
from the undeformed surface, positive into the object; force in N, positive where it pushes the tool
out. Every refusal is a `SpringpotError` of one line: what, where, what to do.
docs/reference/python.md lists everything.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if __name__ != "springpot":
    raise ImportError(f"{__name__}: this is the package springpot itself: import springpot")

if TYPE_CHECKING:
    from springpot.codegen.errors import (
        BudgetError,
        DataError,
        DeviceError,
        MismatchError,
        SpringpotError,
        UnsafeError,
        UsageError,
    )
    from springpot.codegen.model.model import Model
    from springpot.codegen.scene import Budget, Coupling, Device, Guard, Runtime, Scene, Smoothing
    from springpot.files import (
        import_recordings,
        read_model,
        read_recordings,
        read_scene,
        write_model,
        write_recording,
        write_scene,
    )
    from springpot.host.emission.result import Emission
    from springpot.host.session.session import Session
    from springpot.host.stability.check import Stability
    from springpot.host.validation.validation import Validation
    from springpot.loaded import LoadedScene, load
    from springpot.steps import emit, predict, record, stability, train, validate
    from springpot.trainer.ensemble import ensemble_data, from_ensemble
    from springpot.trainer.estimator import PositionRegressor
    from springpot.trainer.kinds import kind_names
    from springpot.trainer.models.fit import Fit, FitOptions
    from springpot.trainer.recordings.conditioning import Conditioning
    from springpot.trainer.recordings.formats.importing import ImportOptions
    from springpot.trainer.recordings.quality.report import QualityReport, check_recordings
    from springpot.trainer.recordings.recording import Recording

# What checkers read above, for the interpreter: module -> names.
_MODULES = {
    "codegen.errors": "BudgetError DataError DeviceError MismatchError SpringpotError UnsafeError "
    "UsageError",
    "codegen.model.model": "Model",
    "codegen.scene": "Budget Coupling Device Guard Runtime Scene Smoothing",
    "files": "import_recordings read_model read_recordings read_scene write_model write_recording "
    "write_scene",
    "host.emission.result": "Emission",
    "host.session.session": "Session",
    "host.stability.check": "Stability",
    "host.validation.validation": "Validation",
    "loaded": "LoadedScene load",
    "steps": "emit predict record stability train validate",
    "trainer.ensemble": "ensemble_data from_ensemble",
    "trainer.estimator": "PositionRegressor",
    "trainer.kinds": "kind_names",
    "trainer.models.fit": "Fit FitOptions",
    "trainer.recordings.conditioning": "Conditioning",
    "trainer.recordings.formats.importing": "ImportOptions",
    "trainer.recordings.quality.report": "QualityReport check_recordings",
    "trainer.recordings.recording": "Recording",
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names.split()}

__version__: str
__all__ = [
    "Budget", "BudgetError", "Conditioning", "Coupling", "DataError", "Device", "DeviceError",
    "Emission", "Fit", "FitOptions", "Guard", "ImportOptions", "LoadedScene", "MismatchError",
    "Model", "PositionRegressor", "QualityReport", "Recording", "Runtime", "Scene", "Session",
    "Smoothing", "SpringpotError", "Stability", "UnsafeError", "UsageError", "Validation",
    "check_recordings", "emit", "ensemble_data", "from_ensemble", "import_recordings",
    "kind_names", "load", "predict", "read_model", "read_recordings", "read_scene", "record",
    "stability", "train", "validate", "write_model", "write_recording", "write_scene",
]  # fmt: skip


# Hidden from checkers, for which every name would exist then.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name == "__version__":
            return import_module("importlib.metadata").version("springpot")
        if name not in _HOMES:
            raise AttributeError(
                f"module 'springpot' has no attribute {name!r}: see dir(springpot)"
            )
        found = globals()[name] = getattr(import_module(f"springpot.{_HOMES[name]}"), name)
        return found


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
