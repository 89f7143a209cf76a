"""springpot in Python: recordings in, a fitted model, C that renders it, and what a hand feels.

    import springpot

Nothing is loaded before it is used. Arrays are numpy's, in SI units: position in m, the penetration
from the undeformed surface, positive into the object; force in N, positive where it pushes the tool
out. Every refusal is a `SpringpotError` of one line: what, where, what to do.
docs/reference/python.md lists everything.
"""

from typing import TYPE_CHECKING, Any

from springpot.lazy_names import lazy_names

if __name__ != "springpot":
    raise ImportError(f"{__name__}: this is the package springpot itself: import springpot")

if TYPE_CHECKING:
    from springpot.codegen.errors import (
        BudgetError as BudgetError,
        DataError as DataError,
        DeviceError as DeviceError,
        MismatchError as MismatchError,
        SpringpotError as SpringpotError,
        UnsafeError as UnsafeError,
        UsageError as UsageError,
    )
    from springpot.codegen.model.model import Model as Model
    from springpot.codegen.scene import (
        Budget as Budget,
        Coupling as Coupling,
        Device as Device,
        Guard as Guard,
        Runtime as Runtime,
        Scene as Scene,
        Smoothing as Smoothing,
    )
    from springpot.files import (
        import_recordings as import_recordings,
        read_model as read_model,
        read_recordings as read_recordings,
        read_scene as read_scene,
        write_model as write_model,
        write_recording as write_recording,
        write_scene as write_scene,
    )
    from springpot.host.emission.result import Emission as Emission
    from springpot.host.session.session import Session as Session
    from springpot.host.stability.check import Stability as Stability
    from springpot.host.validation.validation import Validation as Validation
    from springpot.host.wings.estimators.ensemble import (
        ensemble_data as ensemble_data,
        from_ensemble as from_ensemble,
    )
    from springpot.loaded import LoadedScene as LoadedScene, load as load
    from springpot.steps import (
        emit as emit,
        predict as predict,
        record as record,
        stability as stability,
        train as train,
        validate as validate,
    )
    from springpot.trainer.kinds import kind_names as kind_names
    from springpot.trainer.models.fit import Fit as Fit, FitOptions as FitOptions
    from springpot.trainer.recordings.conditioning import Conditioning as Conditioning
    from springpot.trainer.recordings.formats.importing import ImportOptions as ImportOptions
    from springpot.trainer.recordings.formats.specimen import Specimen as Specimen
    from springpot.trainer.recordings.quality.report import (
        QualityReport as QualityReport,
        check_recordings as check_recordings,
    )
    from springpot.trainer.recordings.recording import Recording as Recording

    __version__: str
else:
    _named, _, __all__ = lazy_names(__name__, __file__)

    def __getattr__(name: str) -> Any:
        from importlib.metadata import version

        found = version("springpot") if name == "__version__" else _named(name)
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        return [*__all__, "__version__"]
