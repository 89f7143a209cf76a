"""What `emit` would render of a model by default: its coupling, and the error behind it."""

from collections.abc import Sequence
from dataclasses import dataclass

from springpot.codegen.coupling.auto import CouplingChoice
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.native.compiler import NoCompilerError
from springpot.codegen.scene import Number, Runtime, Scene
from springpot.host.metrics import Accuracy, accuracy, find_contacts
from springpot.host.native.replay import Replay, replay_forces
from springpot.host.native.scene_library import build_and_load
from springpot.host.validation.compared import (
    resample_to_samples,
    resample_to_ticks,
    samples_at_ticks,
)
from springpot.trainer.recordings.recording import Recording


@dataclass(frozen=True)
class Rendered:
    """Error of the C behind the coupling that `emit` chooses, and that coupling."""

    accuracy: Accuracy
    coupling: CouplingChoice


def measure_rendered(
    model: Model,
    recordings: Sequence[Recording],
    before: Sequence[Recording] = (),
    number: Number = "float32",
) -> Rendered | None:
    """Replay recordings through the C that `emit --model` writes; None without a compiler.

    Those of one session go on after the ones `before`, as the model's own error is measured.
    """
    scene = Scene(schema=1, name="rendered", model="model.spm", runtime=Runtime(number=number))
    plan = make_plan(model, scene, accept_unsafe=True)
    try:
        library = build_and_load(plan)
    except NoCompilerError:
        return None
    ticked = [resample_to_ticks(recording, plan.dt_s) for recording in (*before, *recordings)]
    forces_n, ramps = replay_forces(plan, Replay(library), ticked)
    first = len(before)
    pairs = list(zip(recordings, forces_n[first:], ramps[first:], strict=True))
    return Rendered(
        accuracy(
            [recording.force_n for recording in recordings],
            [resample_to_samples(force_n, item, plan.dt_s) for item, force_n, _ in pairs],
            [samples_at_ticks(ramp, item, plan.dt_s) for item, _, ramp in pairs],
            find_contacts(recordings, plan.contact),
        ),
        plan.coupling,
    )
