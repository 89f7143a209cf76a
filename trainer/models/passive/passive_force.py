"""Force of a fitted passive model along a motion, in float64: the reference of its C."""

from dataclasses import replace

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.model.passive import Hammerstein, Memory
from springpot.codegen.stages.passive.hammerstein import HammersteinStage, hammerstein_stage
from springpot.codegen.stages.passive.motion import PassiveMotion
from springpot.codegen.stages.stage import SceneTicks
from springpot.trainer.models.depths import DepthMotion


def model_along(
    model: Hammerstein, motion: DepthMotion, dt_s: float, surface: bool
) -> tuple[Samples, Samples]:
    """Force along a motion, (n,), N, and the depth at which the model is then, (n,), m.

    That is the tool's, or the surface's while the tool is away.
    """
    return _along(model, motion, dt_s, surface)[:2]


def with_memory(
    model: Hammerstein, motion: DepthMotion, dt_s: float, surface: bool, starts: bool
) -> Hammerstein:
    """The model with its memory at the end of a motion; starts: with which every press begins."""
    memory = _along(model, motion, dt_s, surface)[2]
    return replace(model, conditioned=memory, starts_conditioned=starts)


def _along(
    model: Hammerstein, motion: DepthMotion, dt_s: float, surface: bool
) -> tuple[Samples, Samples, Memory]:
    stage = _stage(model, dt_s, surface)
    u = (motion.depth_m - stage.config.origin_m) * stage.config.per_span
    passive, begin = PassiveMotion(stage, u[0]), 0
    force_n, at = np.empty_like(u), np.empty_like(u)
    for end, seconds in (*motion.pauses, (len(u), 0.0)):
        force_n[begin:end], at[begin:end] = passive.along(u[begin:end])
        if end < len(u):
            passive = _rested(model, passive, u[end : end + 1], seconds, dt_s, surface)
            passive = passive.on(stage)
            force_n[end], at[end] = 0.0, passive.u
        begin = end + 1
    given_n = np.maximum(force_n, 0.0) if surface else force_n
    return given_n, model.origin_m + model.span_m * at, passive.memory(model)


def _rested(
    model: Hammerstein, passive: PassiveMotion, u: Samples, seconds: float, dt_s: float,
    surface: bool,
) -> PassiveMotion:  # fmt: skip
    """Rest at u, (1,), for so long: in steps each twice as long as the one before."""
    step_s, left_s = dt_s, seconds
    while left_s > 0.0:
        step_s = min(2.0 * step_s, left_s)
        passive = passive.on(_stage(model, step_s, surface))
        passive.along(u)
        left_s -= step_s
    return passive


def _stage(model: Hammerstein, dt_s: float, surface: bool) -> HammersteinStage:
    return hammerstein_stage(model, SceneTicks(dt_s, surface=surface), "penetration")
