"""The stability check in its parts: linear loop, small signals, closed loop with a hand.

>>> from springpot.checks import DESIGN_HAND, is_stable, scene_loop
>>> from springpot.emission import make_plan
>>> plan = make_plan(model, scene)
>>> is_stable(plan, scene_loop(plan, DESIGN_HAND))
True
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.coupling.linear_loop import (
        DESIGN_HAND as DESIGN_HAND,
        HAND_MODELS as HAND_MODELS,
        Hand as Hand,
    )
    from springpot.host.stability.check import (
        stability as stability,
    )
    from springpot.host.stability.closed_loop import (
        MORE_DELAY as MORE_DELAY,
        Outcome as Outcome,
        Rendered as Rendered,
        case_outcome as case_outcome,
    )
    from springpot.host.stability.judgement import (
        Grade as Grade,
        judge as judge,
    )
    from springpot.host.stability.linear import (
        is_stable as is_stable,
        loop_words as loop_words,
        require_stable as require_stable,
        scene_loop as scene_loop,
    )
    from springpot.host.stability.small_signal import (
        small_signal_map as small_signal_map,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
