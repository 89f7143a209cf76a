"""Simulated objects and hands, and the cases of the closed loop.

>>> from springpot.simulation import OBJECTS, parse_url
>>> "ecoflex-00-30" in OBJECTS
True
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.recording.protocols import (
        PEAK_N as PEAK_N,
        RATE_HZ as RATE_HZ,
        Profile as Profile,
        cosine_cycles as cosine_cycles,
        inverted_cosine as inverted_cosine,
        load_protocol as load_protocol,
    )
    from springpot.host.simulation.bench import (
        ObjectMotion as ObjectMotion,
        SimulatedHand as SimulatedHand,
    )
    from springpot.host.simulation.cases import cases as cases
    from springpot.host.simulation.hand_loop import (
        HandLoop as HandLoop,
        Operator as Operator,
        Scenario as Scenario,
    )
    from springpot.host.simulation.objects import (
        OBJECTS as OBJECTS,
        VARIANTS as VARIANTS,
        own_class_line as own_class_line,
        parse_url as parse_url,
    )
    from springpot.host.simulation.scenarios import (
        Workspace as Workspace,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
