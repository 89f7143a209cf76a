"""What `auto` selects for a spring: an object without losses."""

from springpot.codegen.coupling.auto import CouplingChoice, select_coupling
from springpot.codegen.coupling.loop_device import LoopDevice
from springpot.codegen.coupling.object_tangent import ObjectTangent
from springpot.codegen.scene import Coupling


def select_for_spring(stiffness_npm: float, dt_s: float, device: LoopDevice) -> CouplingChoice:
    spring = ObjectTangent.from_spring(stiffness_npm)
    return select_coupling(spring, stiffness_npm, dt_s, device, 1.0, Coupling())
