"""Resolve a model and a scene into a plan; the maximum tangent of a model, from its reference."""

from dataclasses import replace

import numpy as np

from springpot.codegen.coupling.auto import CouplingChoice, choose_coupling, series
from springpot.codegen.coupling.gains import couple_config, require_plausible_damping
from springpot.codegen.coupling.loop_device import loop_device
from springpot.codegen.errors import UsageError
from springpot.codegen.limits import (
    guard_config,
    max_mps,
    output_config,
    silence_config,
    watchdog_s_of,
)
from springpot.codegen.model.model import Model
from springpot.codegen.plan import Plan, units_left_out, unused_orders
from springpot.codegen.scene import Scene
from springpot.codegen.stages.model_stages import (
    RangeConfig,
    Stages,
    clip,
    model_force,
    model_stages,
)
from springpot.codegen.stages.stage import SceneTicks, vector_width_of
from springpot.codegen.stages.windows import tool_velocity_stage

RATES_HZ = (10.0, 8000.0)
SERVED_HZ = (1000.0, 2000.0, 4000.0, 8000.0)  # force-feedback devices: commonly the first
FELT_SHARE = 0.8  # less is another object to a hand: the difference that it notices is 15 to 22 %
ONSET = 0.01  # of the trained depth: over which the force rises from zero behind the surface
FADE = 0.1  # of the trained depth: where guard.outside = "zero" ends the force
STEP = 0.05  # of the trained depth: longer than a leaf of a forest, shorter than a press
RANGE_FACTOR = 1.3  # of the trained depth: the fallback counts too
_SPEEDS = (1.0, 0.25, 0.0625)  # of the maximum trained one
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
        return _plan(model, scene, accept_unsafe)
    if 1.0 / model.dt_s >= RATES_HZ[0] * 0.999:
        plan = _plan(model, scene, accept_unsafe)
        if plan.coupling.felt_npm >= FELT_SHARE * plan.stiffness_npm:
            return plan
    served = replace(scene, runtime=replace(runtime, rate_hz=SERVED_HZ[0]))
    return replace(_plan(model, served, accept_unsafe), chose_rate=True)


def _plan(model: Model, scene: Scene, accept_unsafe: bool) -> Plan:
    ticks = SceneTicks(
        dt_s=_time_step(model, scene),
        dtype=np.float32 if scene.runtime.number == "float32" else np.float64,
        vector_width=vector_width_of(scene.runtime),
        surface=(scene.guard.contact or model.contact) == "surface",
        conditioned={"auto": None, "rested": False, "conditioned": True}[scene.runtime.start],
    )
    dt_s, dtype, contact = ticks.dt_s, ticks.dtype, ticks.surface
    watchdog_s = watchdog_s_of(scene, dt_s)
    stages = model_stages(model, scene, ticks)
    trained = RangeConfig(
        min_m=dtype(0.0 if contact else model.trained.min_m), max_m=dtype(model.trained.max_m)
    )
    fade_m = FADE * (float(trained.max_m) - float(trained.min_m))
    output = output_config(model, scene, ticks)
    stiffness_npm = max_stiffness_npm(stages, model, trained, ticks, float(output.max_n))
    choice = _coupling(scene, stiffness_npm, dt_s)
    couple = None
    if choice.coupling.mode != "off":
        if not accept_unsafe:
            require_plausible_damping(choice.coupling)
        couple = couple_config(choice.coupling, dt_s, dtype)
    estimates = couple is not None and scene.device.velocity == "estimate"
    alpha = _smooth_alpha(scene, dt_s)
    return Plan(
        **vars(stages),
        scene=scene,
        model=model,
        real="float" if dtype is np.float32 else "double",
        dt_s=dt_s,
        guard=guard_config(model, watchdog_s, ticks),
        range=trained,
        per_onset=dtype(1.0 / (ONSET * model.trained.max_m)) if contact else None,
        per_fade=dtype(1.0 / fade_m) if scene.guard.outside == "zero" else None,
        velocity=tool_velocity_stage(ticks) if estimates else None,
        couple=couple,
        at_proxy=choice.coupling.mode == "proxy",
        max_mps=dtype(max_mps(model)),
        smooth_alpha=None if alpha is None else dtype(alpha),
        output=output,
        silence=silence_config(watchdog_s, ticks),
        watchdog_s=float(dtype(watchdog_s)),
        left_out=(
            *unused_orders(model, dtype),
            *units_left_out(scene, ticks, couple is not None, estimates, alpha),
        ),
        accept_unsafe=accept_unsafe,
        stiffness_npm=stiffness_npm,
        coupling=choice,
        outside=_outside_note(model, scene),
    )


def _time_step(model: Model, scene: Scene) -> float:
    trained_hz, rate_hz = 1.0 / model.dt_s, scene.runtime.rate_hz
    if rate_hz is not None and model.exact_at_any_rate:
        return 1.0 / rate_hz  # poles are exact at any rate
    if not RATES_HZ[0] * 0.999 <= trained_hz <= RATES_HZ[1] * 1.001:
        way = "import the recordings with --resample-hz"
        if model.exact_at_any_rate:
            way = "give [runtime] rate_hz = 1000, at which it is as exact"
        raise UsageError(
            f"the model was recorded at {trained_hz:g} Hz: a loop runs at {RATES_HZ[0]:g} to "
            f"{RATES_HZ[1]:g} Hz: {way}"
        )
    if rate_hz is not None and abs(rate_hz * model.dt_s - 1.0) > 1e-3:
        raise UsageError(
            f"runtime.rate_hz = {rate_hz:g}: the model's features were fitted at {trained_hz:g} Hz "
            f"and are not exact at another rate: remove the key, or train on recordings of "
            f"{rate_hz:g} Hz"
        )
    return model.dt_s


def _coupling(scene: Scene, stiffness_npm: float, dt_s: float) -> CouplingChoice:
    stated = scene.coupling
    if stated.mode == "auto":
        smoothing = _smooth_alpha(scene, dt_s) or 1.0
        device = loop_device(scene.device, dt_s)
        return choose_coupling(stiffness_npm, dt_s, device, smoothing, stated)
    felt_npm = stiffness_npm
    if stated.mode == "proxy":
        felt_npm = series(stated.stiffness_npm, stiffness_npm)
    return CouplingChoice(stated, f"{stated.mode}: stated in the scene", felt_npm)


def _smooth_alpha(scene: Scene, dt_s: float) -> float | None:
    time_constant_s = scene.smoothing.time_constant_s
    return None if time_constant_s == 0.0 else float(-np.expm1(-dt_s / time_constant_s))


def _outside_note(model: Model, scene: Scene) -> str:
    if scene.guard.outside == "zero":
        return (
            "zero: stated in the scene; the force ends over the first "
            f"{100 * FADE:g} % of the depth beyond the trained one"
        )
    if scene.guard.outside == "fallback" and model.hammerstein is not None:
        return "fallback: the passive model adds its share of the depth beyond the trained one"
    stated = scene.guard.outside == "hold"
    why = "stated in the scene" if stated else "the model has no passive part"
    return f"hold: {why}; the force stays that of the maximum trained depth"


def max_stiffness_npm(
    stages: Stages, model: Model, trained: RangeConfig, ticks: SceneTicks, max_n: float
) -> float:
    """Maximum secant over 5 % of the depth, pressed from rest at any depth, N/m.

    Of a force up to the maximum, which is all that a hand feels.
    """
    base_m = float(trained.min_m)
    span_m = float(trained.max_m) - base_m
    starts_m = base_m + span_m * np.arange(0.0, RANGE_FACTOR, STEP)
    found = 0.0
    for share in _SPEEDS:
        count = 1 + max(1, round(STEP * span_m / (share * model.trained.max_mps * ticks.dt_s)))
        count = min(count, _MAX_TICKS)
        rise_m = STEP * span_m * np.linspace(0.0, 1.0, count)
        motion = (starts_m[:, None] + rise_m).astype(ticks.dtype)
        penetration = motion.ravel()
        motions = {"penetration": penetration, "clipped": clip(trained, penetration)[0]}
        starts = np.arange(0, len(penetration), count)
        force_n = model_force(stages, motions, starts, np.ones(len(penetration), dtype=bool))
        force_n = force_n.reshape(motion.shape).astype(np.float64)
        felt_n = np.minimum(force_n, max_n)
        found = max(found, float((felt_n[:, -1] - felt_n[:, 0]).max()) / (STEP * span_m))
    return found
