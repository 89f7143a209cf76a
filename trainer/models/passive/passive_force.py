"""Force of a fitted passive model along a motion, in float64: the reference of its C."""

from dataclasses import replace
from functools import cache

import numpy as np

from springpot.codegen.arrays import Samples, rms
from springpot.codegen.model.passive import Hammerstein, Memory
from springpot.codegen.stages.passive.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.stages.stage import SceneTicks
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.training_set import TrainingSet
from springpot.trainer.recordings.recording import Site

_CLEARLY = 0.9  # times the error


def model_along(
    model: Hammerstein, motion: DepthMotion, dt_s: float, surface: bool, place_m: Site | None = None
) -> tuple[Samples, Samples, Memory]:
    """Force along a motion, (n,), N, the depth at which the model is then, (n,), m, and its memory.

    That is the tool's, or the surface's while the tool is away. place_m: of a map, x and y, m;
    None: of the stiffest.
    """

    @cache
    def stage_of(step_s: float) -> HammersteinStage:
        ticks = SceneTicks(step_s, surface=surface)
        return hammerstein_stage(model, ticks, "penetration").at(place_m)

    stage = stage_of(dt_s)
    u = (motion.depth_m - stage.config.origin_m) * stage.config.per_span
    passive, begin = PassiveMotion(stage, u[0]), 0
    force_n, at = np.empty_like(u), np.empty_like(u)
    for end, seconds in (*motion.pauses, (len(u), 0.0)):
        force_n[begin:end], at[begin:end] = passive.along(u[begin:end])
        if end < len(u):
            step_s, left_s = dt_s, seconds  # steps of a rest, each twice as long as the one before
            while left_s > 0.0:
                step_s = min(2.0 * step_s, left_s)
                passive = passive.on(stage_of(step_s))
                passive.along(u[end : end + 1])
                left_s -= step_s
            passive = passive.on(stage)
            force_n[end], at[end] = 0.0, passive.u
        begin = end + 1
    given_n = np.maximum(force_n, 0.0) if surface else force_n
    return given_n, model.origin_m + model.span_m * at, passive.memory(model)


def with_memory(model: Hammerstein, data: TrainingSet) -> Hammerstein:
    """The model with the memory with which the last press began; untimed, with which it ended.

    Presses begin with it where the recordings go on, or where it takes a tenth off the error of
    the later presses of a timed session, each by itself: their rests were too short to forget in.
    """
    motion, surface = data.motions[-1], data.contact == "surface"
    if data.continues or len(motion.recordings) < 2:
        memory = model_along(model, motion, data.dt_s, surface)[2]
        return replace(model, conditioned=memory, starts_conditioned=data.continues)
    begin = motion.starts[-1]
    pauses = tuple(pause for pause in motion.pauses if pause[0] < begin)
    before = replace(motion, depth_m=motion.depth_m[:begin], pauses=pauses)
    memory = model_along(model, before, data.dt_s, surface)[2]
    later = motion.recordings[(len(motion.recordings) + 1) // 2 :]

    def error_n(starting: Hammerstein) -> float:
        alone = (DepthMotion(data.depths_m[k], (k,), (0,)) for k in later)
        found_n = [model_along(starting, each, data.dt_s, surface)[0] for each in alone]
        return rms(
            np.concatenate(found_n) - np.concatenate([data.recordings[k].force_n for k in later])
        )

    rested = replace(model, conditioned=memory, starts_conditioned=False)
    worn = replace(rested, starts_conditioned=True)
    return worn if error_n(worn) < _CLEARLY * error_n(rested) else rested
