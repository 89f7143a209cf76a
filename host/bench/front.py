"""The front, and what is measured of its models alone on the machine."""

import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from springpot.codegen.errors import UnsafeError, UsageError
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Number, Runtime, Scene, Target
from springpot.host.bench.measure import Point, bench_scene
from springpot.host.emission.boards import TickCost, count_instructions
from springpot.host.emission.emission import write_emission
from springpot.host.files import read_model
from springpot.host.native.replay import Replay, TickTimes
from springpot.host.native.scene_library import build_and_load
from springpot.host.stability.check import stability
from springpot.host.stability.linear import require_stable, spectral_radius
from springpot.host.validation.rendered import measure_rendered
from springpot.trainer.recordings.recording import Recording

PACED_S = 2.0
_PACED_TRIES = 3
_DISTURBED = 5.0  # times the median: other work had the processor in one of 100 ticks
_AXES = ("rmse_n", "tick_ns_hot", "flash_bytes")
ALONE = ("tick_ns_p50", "tick_ns_p99", "tick_ns_p999", "tick_ns_max", "bounded",
         "spectral_radius", "held_times_as_stiff", "verdict", "instructions",
         "instructions_after_silence", "instructions_why", "rendered_rmse_n",
         "rendered_rmse_percent_of_peak", "rendered_contact_below_jnd", "coupling")  # fmt: skip


def pareto_front(points: Iterable[Point]) -> list[bool]:
    """Return of each point if no other is better in one of error, time and flash, and no worse."""
    rows = [[point[axis] for axis in _AXES] for point in points]
    return [not any(_dominates(other, row) for other in rows) for row in rows]


def _dominates(one: Sequence[object], other: Sequence[object]) -> bool:
    """Return True if one result is better in something and nowhere worse, in what both know."""
    known = [
        (a, b)
        for a, b in zip(one, other, strict=True)
        if isinstance(a, float | int) and isinstance(b, float | int)
    ]
    return any(a < b for a, b in known) and all(a <= b for a, b in known)


def measure_alone(
    model_file: Path,
    number: Number,
    target: Target,
    key: str,
    recording: Recording,
    validation: Sequence[Recording],
    training: Sequence[Recording],
) -> Point:
    """Return paced ticks, the scene with hands and its error, instructions on the target.

    key: of all that decides the result besides: joblib remembers by it.
    """
    model = read_model(model_file)
    cost = _counted(model, number, target)
    return {
        **_paced_ticks(model, number, recording),
        **_closed_loop(model, number),
        **_rendered(model, number, validation, training),
        "instructions": cost.usual,
        "instructions_after_silence": cost.after_silence,
        "instructions_why": cost.why,
    }


def _paced_ticks(model: Model, number: Number, recording: Recording) -> Point:
    """Time ticks at the recordings' rate with cold caches, ns; the calmest of up to three runs."""
    plan = make_plan(model, bench_scene(number), accept_unsafe=True)
    library = build_and_load(plan)
    tries: list[TickTimes] = []
    while not tries or (len(tries) < _PACED_TRIES and tries[-1].p99 > _DISTURBED * tries[-1].p50):
        tries.append(Replay(library).tick_times(recording.position_m, PACED_S))
    ticks = min(tries, key=lambda times: times.p99)
    return {f"tick_ns_{name}": getattr(ticks, name) for name in ("p50", "p99", "p999", "max")}


def _closed_loop(model: Model, number: Number) -> Point:
    """Press the scene with all hands: is every case bounded, and would `emit` accept it."""
    scene = Scene(schema=1, name="bench", model="model.spm", runtime=Runtime(number=number))
    try:
        plan = make_plan(model, scene)
        require_stable(plan)
        verdict = stability(plan)
    except UnsafeError as error:
        return {"bounded": False, "spectral_radius": None, "held_times_as_stiff": None,
                "verdict": str(error)}  # fmt: skip
    whole = [outcome for outcome in verdict.outcomes if outcome.losses is None]
    return {
        "bounded": verdict.check.stable and all(outcome.bounded for outcome in whole),
        "spectral_radius": spectral_radius(plan),
        "held_times_as_stiff": verdict.check.margin.least,
        "verdict": verdict.as_dict()["recommendation"],
    }


def _rendered(
    model: Model, number: Number, validation: Sequence[Recording], training: Sequence[Recording]
) -> Point:
    """Return the error behind the coupling that `emit` chooses: what a hand would feel."""
    rendered = measure_rendered(model, validation, training, number)
    assert rendered is not None  # the model's own C was built before
    return {
        "rendered_rmse_n": rendered.accuracy.rmse_n,
        "rendered_rmse_percent_of_peak": rendered.accuracy.rmse_percent_of_peak,
        "rendered_contact_below_jnd": rendered.accuracy.contact_below_jnd,
        "coupling": rendered.coupling.why,
    }


def _counted(model: Model, number: Number, target: Target) -> TickCost:
    """Count the instructions of a tick of the model alone on the target."""
    scene = bench_scene(number, target)
    try:
        plan = make_plan(model, scene, accept_unsafe=True)
    except UsageError as error:  # a regressor that needs libm
        return TickCost(None, None, str(error))
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        folder = Path(scratch) / "c"
        write_emission(plan, scene, model, folder)
        return count_instructions(folder, plan)
