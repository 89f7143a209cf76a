"""Simulated objects and hands, and the cases of the closed loop.

>>> from springpot.simulation import OBJECTS, parse_url
>>> "ecoflex-00-30" in OBJECTS
True
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.recording.protocols import (
        RATE_HZ as RATE_HZ,
    )
    from springpot.host.recording.protocols import (
        Profile as Profile,
    )
    from springpot.host.recording.protocols import cosine_cycles as cosine_cycles
    from springpot.host.recording.protocols import inverted_cosine as inverted_cosine
    from springpot.host.recording.protocols import (
        load_protocol as load_protocol,
    )
    from springpot.host.simulation.bench import (
        ObjectMotion as ObjectMotion,
    )
    from springpot.host.simulation.bench import (
        SimulatedHand as SimulatedHand,
    )
    from springpot.host.simulation.cases import cases as cases
    from springpot.host.simulation.hand_loop import (
        HandLoop as HandLoop,
    )
    from springpot.host.simulation.hand_loop import (
        LoopCalls as LoopCalls,
    )
    from springpot.host.simulation.hand_loop import (
        Operator as Operator,
    )
    from springpot.host.simulation.hand_loop import (
        Scenario as Scenario,
    )
    from springpot.host.simulation.objects import (
        OBJECTS as OBJECTS,
    )
    from springpot.host.simulation.objects import (
        VARIANTS as VARIANTS,
    )
    from springpot.host.simulation.objects import (
        own_class_line as own_class_line,
    )
    from springpot.host.simulation.objects import (
        parse_url as parse_url,
    )
    from springpot.host.simulation.scenarios import RISE_S as RISE_S
    from springpot.host.simulation.scenarios import Workspace as Workspace
    from springpot.host.simulation.scenarios import holding as holding
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
