"""Plans, and the C that is emitted from them, with its numpy reference.

>>> from springpot.emission import make_plan, run_reference
>>> plan = make_plan(model, scene)
>>> plan.dt_s
0.001
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.coupling.gains import couple_config as couple_config
    from springpot.codegen.emit.golden import (
        backward_velocity as backward_velocity,
        golden_positions as golden_positions,
    )
    from springpot.codegen.emit.header import named as named, prefixed as prefixed
    from springpot.codegen.literals import literal as literal
    from springpot.codegen.plan.make_plan import make_plan as make_plan
    from springpot.codegen.plan.plan import Plan as Plan
    from springpot.codegen.plan.units import (
        instruction_bound as instruction_bound,
        planned_headers as planned_headers,
        state_bytes as state_bytes,
        state_members as state_members,
    )
    from springpot.codegen.reference.notes import (
        LATCHED as LATCHED,
        RESYNC as RESYNC,
    )
    from springpot.codegen.reference.run import run_reference as run_reference
    from springpot.codegen.reference.tick import Coupled as Coupled
    from springpot.codegen.stages.stage import (
        Columns as Columns,
        FeatureStage as FeatureStage,
        Member as Member,
        RegressorStage as RegressorStage,
        feature_stage as feature_stage,
        regressor_stage as regressor_stage,
    )
    from springpot.host.emission.checksums import (
        is_edited as is_edited,
        require_replaceable as require_replaceable,
        write_checksums as write_checksums,
    )
    from springpot.host.emission.emission import (
        Emitted as Emitted,
        read_emission as read_emission,
        require_emission as require_emission,
        write_emission as write_emission,
    )
    from springpot.host.emission.folder import emitted_folder as emitted_folder
    from springpot.host.emission.result import over_budget as over_budget
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
