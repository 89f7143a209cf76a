"""Resolve a model and a scene into a plan; the maximum tangent of a model, from its reference."""

from dataclasses import replace

import numpy as np

from springpot.codegen.coupling.auto import CouplingChoice, select_coupling, series_stiffness_npm
from springpot.codegen.coupling.gains import build_couple_config, require_plausible_damping
from springpot.codegen.coupling.loop_device import build_loop_device
from springpot.codegen.coupling.object_tangent import ObjectTangent, compute_passive_tangent
from springpot.codegen.errors import UsageError
from springpot.codegen.limits import (
    build_guard_config,
    build_output_config,
    build_silence_config,
    watchdog_timeout_s,
)
from springpot.codegen.model.model import Model
from springpot.codegen.plan import Plan, find_left_out_units, find_unused_orders
from springpot.codegen.scene import Scene
from springpot.codegen.stages.model_stages import (
    RangeConfig,
    Stages,
    build_stages,
    clip_depth,
    compute_model_force,
)
from springpot.codegen.stages.stage import SceneTicks, select_vector_width
from springpot.codegen.stages.windows import build_tool_velocity_stage

RATES_HZ = (10.0, 8000.0)
SERVED_HZ = (1000.0, 2000.0, 4000.0, 8000.0)  # force-feedback devices: commonly the first
MIN_FELT_FRACTION = (
    0.8  # less is another object to a hand: the difference that it notices is 15 to 22 %
)
ONSET_DEPTH_FRACTION = (
    0.01  # of the trained depth: over which the force rises from zero behind the surface
)
FADE_DEPTH_FRACTION = 0.1  # of the trained depth: where guard.outside = "zero" ends the force
SECANT_DEPTH_FRACTION = (
    0.05  # of the trained depth: longer than a leaf of a forest, shorter than a press
)
SEARCH_DEPTH_RATIO = 1.3  # of the trained depth: the fallback counts too
_SPEED_FRACTIONS = (1.0, 0.25, 0.0625)  # of the maximum trained one
_MAX_TICKS = 200


def make_plan(model: Model, scene: Scene, accept_unsafe: bool = False) -> Plan:
    """Resolve `scene` for `model`. Raises UsageError for what the two cannot do together.

    Without a rate, a scene ticks at the recordings'; if that is below 1000 Hz and holds no coupling
    that leaves the object's stiffness, and the model is exact at any rate, at 1000 Hz. Raises
    UnsafeError for gains that are a unit error, unless accepted.
    """
    runtime = scene.runtime
    slow = runtime.rate_hz is None and model.dt_s * SERVED_HZ[0] > 1.001
    if not (slow and model.exact_at_any_rate and scene.coupling.mode == "auto"):
        return _build_plan(model, scene, accept_unsafe)
    if 1.0 / model.dt_s >= RATES_HZ[0] * 0.999:
        plan = _build_plan(model, scene, accept_unsafe)
        if plan.coupling.felt_npm >= MIN_FELT_FRACTION * plan.stiffness_npm:
            return plan
    served = replace(scene, runtime=replace(runtime, rate_hz=SERVED_HZ[0]))
    return replace(_build_plan(model, served, accept_unsafe), chose_rate=True)


def _build_plan(model: Model, scene: Scene, accept_unsafe: bool) -> Plan:
    """Resolve model and scene at one rate: the model's stages, limits, coupling."""
    ticks = SceneTicks(
        dt_s=_select_time_step(model, scene),
        dtype=np.float32 if scene.runtime.number == "float32" else np.float64,
        vector_width=select_vector_width(scene.runtime),
        surface=(scene.guard.contact or model.contact) == "surface",
        start_reach_m=model.start_reach_m,
    )
    dt_s, dtype, contact = ticks.dt_s, ticks.dtype, ticks.surface
    watchdog_s = watchdog_timeout_s(scene, dt_s)
    stages = build_stages(model.with_start(scene.runtime.start), scene, ticks)
    trained = RangeConfig(
        min_m=dtype(0.0 if contact else model.trained.min_m), max_m=dtype(model.trained.max_m)
    )
    fade_m = FADE_DEPTH_FRACTION * (float(trained.max_m) - float(trained.min_m))
    output = build_output_config(model, scene, ticks)
    # A rested object is the stiffest: damage, or a surface that is not back yet, takes from it.
    rested = build_stages(model.with_start("rested"), scene, ticks)
    stiffness_npm = find_max_stiffness_npm(rested, model, trained, ticks, float(output.max_n))
    tangent = compute_tangent(rested, trained, float(output.max_n), stiffness_npm)
    choice = _select_coupling(scene, stiffness_npm, tangent, dt_s)
    couple = None
    if choice.coupling.mode != "off":
        if not accept_unsafe:
            require_plausible_damping(choice.coupling)
        couple = build_couple_config(choice.coupling, dt_s, dtype)
    alpha = _compute_alpha(scene, dt_s)
    return Plan(
        **vars(stages),
        scene=scene,
        model=model,
        real="float" if dtype is np.float32 else "double",
        dt_s=dt_s,
        guard=build_guard_config(model, watchdog_s, ticks, couple is not None),
        range=trained,
        onset_per_m=dtype(1.0 / (ONSET_DEPTH_FRACTION * model.trained.max_m)) if contact else None,
        fade_per_m=dtype(1.0 / fade_m) if scene.guard.outside == "zero" else None,
        velocity=build_tool_velocity_stage(ticks) if couple is not None else None,
        couple=couple,
        at_proxy=choice.coupling.mode == "proxy",
        smooth_alpha=None if alpha is None else dtype(alpha),
        output=output,
        silence=build_silence_config(watchdog_s, ticks),
        watchdog_s=float(dtype(watchdog_s)),
        left_out=(
            *find_unused_orders(model, dtype),
            *find_left_out_units(scene, ticks, couple is not None, alpha),
        ),
        accept_unsafe=accept_unsafe,
        stiffness_npm=stiffness_npm,
        tangent=tangent,
        coupling=choice,
        outside=_outside_note(model, scene),
    )


def _select_time_step(model: Model, scene: Scene) -> float:
    """Return the seconds of a tick: the scene's rate if the model is exact there, else its own."""
    trained_hz, rate_hz = 1.0 / model.dt_s, scene.runtime.rate_hz
    if rate_hz is not None and model.exact_at_any_rate:
        return 1.0 / rate_hz  # poles are exact at any rate
    if not RATES_HZ[0] * 0.999 <= trained_hz <= RATES_HZ[1] * 1.001:
        remedy = "import the recordings with --resample-hz"
        if model.exact_at_any_rate:
            remedy = "give [runtime] rate_hz = 1000, at which it is as exact"
        raise UsageError(
            f"the model was recorded at {trained_hz:g} Hz: a loop runs at {RATES_HZ[0]:g} to "
            f"{RATES_HZ[1]:g} Hz: {remedy}"
        )
    if rate_hz is not None and abs(rate_hz * model.dt_s - 1.0) > 1e-3:
        raise UsageError(
            f"runtime.rate_hz = {rate_hz:g}: the model's features were fitted at {trained_hz:g} Hz "
            f"and are not exact at another rate: remove the key, or train on recordings of "
            f"{rate_hz:g} Hz"
        )
    return model.dt_s


def compute_tangent(
    stages: Stages, trained: RangeConfig, max_n: float, stiffness_npm: float
) -> ObjectTangent:
    """Return the model as a small motion meets it; a regressor counts as its stiffest spring."""
    if stages.passive is None or stages.regressor is not None:
        return ObjectTangent.from_spring(stiffness_npm)
    base_m = float(trained.min_m)
    return compute_passive_tangent(stages.passive, base_m, float(trained.max_m) - base_m, max_n)


def _select_coupling(
    scene: Scene, stiffness_npm: float, tangent: ObjectTangent, dt_s: float
) -> CouplingChoice:
    """Return the coupling that the scene states, or the one that "auto" finds for it."""
    stated = scene.coupling
    if stated.mode == "auto":
        smoothing = _compute_alpha(scene, dt_s) or 1.0
        device = build_loop_device(scene.device, dt_s)
        return select_coupling(tangent, stiffness_npm, dt_s, device, smoothing, stated)
    felt_npm = stiffness_npm
    if stated.mode == "proxy":
        felt_npm = series_stiffness_npm(stated.stiffness_npm, stiffness_npm)
    return CouplingChoice(stated, f"{stated.mode}: stated in the scene", felt_npm)


def _compute_alpha(scene: Scene, dt_s: float) -> float | None:
    time_constant_s = scene.smoothing.time_constant_s
    return None if time_constant_s == 0.0 else float(-np.expm1(-dt_s / time_constant_s))


def _outside_note(model: Model, scene: Scene) -> str:
    """Say what the force does beyond the trained depth, and why."""
    if scene.guard.outside == "zero":
        return (
            "zero: stated in the scene; the force ends over the first "
            f"{100 * FADE_DEPTH_FRACTION:g} % of the depth beyond the trained one"
        )
    if scene.guard.outside == "fallback" and model.hammerstein is not None:
        return "fallback: the passive model adds its share of the depth beyond the trained one"
    stated = scene.guard.outside == "hold"
    why = "stated in the scene" if stated else "the model has no passive part"
    return f"hold: {why}; the force stays that of the maximum trained depth"


def find_max_stiffness_npm(
    stages: Stages, model: Model, trained: RangeConfig, ticks: SceneTicks, max_n: float
) -> float:
    """Return the greatest stiffness that the model shows a hand, N/m.

    The secant over 5 % of the depth, pressed from rest at any depth at several speeds; of a force
    up to the clamp, which is all that a hand feels.
    """
    base_m = float(trained.min_m)
    span_m = float(trained.max_m) - base_m
    starts_m = base_m + span_m * np.arange(0.0, SEARCH_DEPTH_RATIO, SECANT_DEPTH_FRACTION)
    max_npm = 0.0
    for speed_fraction in _SPEED_FRACTIONS:
        count = 1 + max(
            1,
            round(
                SECANT_DEPTH_FRACTION
                * span_m
                / (speed_fraction * model.trained.max_mps * ticks.dt_s)
            ),
        )
        count = min(count, _MAX_TICKS)
        rise_m = SECANT_DEPTH_FRACTION * span_m * np.linspace(0.0, 1.0, count)
        motion = (starts_m[:, None] + rise_m).astype(ticks.dtype)
        penetration = motion.ravel()
        motions = {"penetration": penetration, "clipped": clip_depth(trained, penetration)[0]}
        starts = np.arange(0, len(penetration), count)
        force_n = compute_model_force(
            stages, motions, starts, np.ones(len(penetration), dtype=bool)
        )
        force_n = force_n.reshape(motion.shape).astype(np.float64)
        felt_n = np.minimum(force_n, max_n)
        max_npm = max(
            max_npm, float((felt_n[:, -1] - felt_n[:, 0]).max()) / (SECANT_DEPTH_FRACTION * span_m)
        )
    return max_npm
