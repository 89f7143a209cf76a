"""Force of a fitted passive model along a motion, in float64: the reference of its C."""

from dataclasses import replace
from functools import cache
from math import inf

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.model.passive import Hammerstein, Memory
from springpot.codegen.stages.passive.compiled import CompiledMotion
from springpot.codegen.stages.passive.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.stage import SceneTicks
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Site

_MAX_ERROR_RATIO = 0.9  # times the error


def simulate_passive(
    model: Hammerstein,
    motion: DepthMotion,
    dt_s: float,
    surface: bool,
    place_m: Site | None = None,
    start_reach_m: float = inf,
) -> tuple[Samples, Samples, Memory]:
    """Simulate a passive model along a motion: force, (n,), N, surface's depth, (n,), m, memory.

    The depth is the tool's, or the surface's while the tool is away. place_m: of a map, x and y, m;
    None: of the stiffest. start_reach_m: see `Model`. A model that continues knows what came before
    a motion: the guess of that in the motion is passed over (0 there).
    """

    @cache
    def stage_of(step_s: float) -> HammersteinStage:
        ticks = SceneTicks(step_s, surface=surface, start_reach_m=start_reach_m)
        return hammerstein_stage(model, ticks, "penetration").at(place_m)

    stage = stage_of(dt_s)
    u = (motion.depth_m - stage.config.origin_m) * stage.config.u_per_m
    begin = motion.starts[0] if stage.start else 0
    state, force_n, model_u = CompiledMotion(stage, u[begin]), np.zeros_like(u), u.copy()
    pauses = (pause for pause in motion.pauses if pause[0] > begin)
    for end, seconds in (*pauses, (len(u), 0.0)):
        force_n[begin:end], model_u[begin:end] = state.along(u[begin:end])
        if end < len(u):
            step_s, left_s = dt_s, seconds  # steps of a rest, each twice as long as the one before
            while left_s > 0.0:
                step_s = min(2.0 * step_s, left_s)
                state = state.with_stage(stage_of(step_s))
                state.along(u[end : end + 1])
                left_s -= step_s
            state = state.with_stage(stage)
            force_n[end], model_u[end] = 0.0, state.u
        begin = end + 1
    rendered_n = np.maximum(force_n, 0.0) if surface else force_n
    return rendered_n, model.origin_m + model.span_m * model_u, state.memory(model)


def store_memory(model: Hammerstein, data: TrainingSet) -> Hammerstein:
    """Store in the model the state with which its last press began, for scenes that go on.

    Of untimed recordings, with which it ended. Presses begin with it where the recordings go on, or
    where it takes a tenth off the error of the later presses of a timed session, each by itself:
    their rests were too short to forget in.
    """
    motion, surface = data.motions[-1], data.contact == "surface"
    if data.continues or len(motion.recordings) < 2:
        memory = simulate_passive(model, motion, data.dt_s, surface)[2]
        end_depth_m = float(motion.depth_m[-1]) if len(data.recordings) == 1 else None
        return replace(model, end_memory=memory, continues=data.continues, end_depth_m=end_depth_m)
    begin = motion.starts[-1]
    pauses = tuple(pause for pause in motion.pauses if pause[0] < begin)
    earlier = replace(motion, depth_m=motion.depth_m[:begin], pauses=pauses)
    memory = simulate_passive(model, earlier, data.dt_s, surface)[2]
    later = motion.recordings[(len(motion.recordings) + 1) // 2 :]

    def error_n(starting: Hammerstein) -> float:
        """Return the RMSE of the later presses, each by itself, from a start, N."""
        separate = (DepthMotion(data.depths_m[k], (k,), (0,)) for k in later)
        simulated_n = [
            simulate_passive(starting, press, data.dt_s, surface)[0] for press in separate
        ]
        return rms(
            np.concatenate(simulated_n)
            - np.concatenate([data.recordings[k].force_n for k in later])
        )

    rested = replace(model, end_memory=memory, continues=False)
    conditioned = replace(rested, continues=True)
    return conditioned if error_n(conditioned) < _MAX_ERROR_RATIO * error_n(rested) else rested
