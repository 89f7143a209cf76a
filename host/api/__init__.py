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
    )
    from springpot.codegen.errors import (
        DataError as DataError,
    )
    from springpot.codegen.errors import (
        DeviceError as DeviceError,
    )
    from springpot.codegen.errors import (
        MismatchError as MismatchError,
    )
    from springpot.codegen.errors import (
        SpringpotError as SpringpotError,
    )
    from springpot.codegen.errors import (
        UnsafeError as UnsafeError,
    )
    from springpot.codegen.errors import (
        UsageError as UsageError,
    )
    from springpot.codegen.model.model import Model as Model
    from springpot.codegen.scene import (
        Budget as Budget,
    )
    from springpot.codegen.scene import (
        Coupling as Coupling,
    )
    from springpot.codegen.scene import (
        Device as Device,
    )
    from springpot.codegen.scene import (
        Guard as Guard,
    )
    from springpot.codegen.scene import (
        Runtime as Runtime,
    )
    from springpot.codegen.scene import (
        Scene as Scene,
    )
    from springpot.codegen.scene import (
        ScenePlaces as ScenePlaces,
    )
    from springpot.codegen.scene import (
        Smoothing as Smoothing,
    )
    from springpot.files import (
        import_recordings as import_recordings,
    )
    from springpot.files import (
        read_model as read_model,
    )
    from springpot.files import (
        read_recordings as read_recordings,
    )
    from springpot.files import (
        read_scene as read_scene,
    )
    from springpot.files import (
        write_model as write_model,
    )
    from springpot.files import (
        write_recording as write_recording,
    )
    from springpot.files import (
        write_scene as write_scene,
    )
    from springpot.host.emission.result import Emission as Emission
    from springpot.host.session.session import Session as Session
    from springpot.host.stability.check import Stability as Stability
    from springpot.host.validation.validation import Validation as Validation
    from springpot.loaded import LoadedScene as LoadedScene
    from springpot.loaded import load as load
    from springpot.steps import (
        emit as emit,
    )
    from springpot.steps import (
        predict as predict,
    )
    from springpot.steps import (
        record as record,
    )
    from springpot.steps import (
        stability as stability,
    )
    from springpot.steps import (
        train as train,
    )
    from springpot.steps import (
        validate as validate,
    )
    from springpot.trainer.ensemble import (
        ensemble_data as ensemble_data,
    )
    from springpot.trainer.ensemble import (
        from_ensemble as from_ensemble,
    )
    from springpot.trainer.estimator import (
        PositionRegressor as PositionRegressor,
    )
    from springpot.trainer.estimator import (
        neg_rmse_n as neg_rmse_n,
    )
    from springpot.trainer.kinds import kind_names as kind_names
    from springpot.trainer.models.fit import Fit as Fit
    from springpot.trainer.models.fit import FitOptions as FitOptions
    from springpot.trainer.recordings.conditioning import Conditioning as Conditioning
    from springpot.trainer.recordings.formats.importing import ImportOptions as ImportOptions
    from springpot.trainer.recordings.quality.report import (
        QualityReport as QualityReport,
    )
    from springpot.trainer.recordings.quality.report import (
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
