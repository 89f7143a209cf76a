"""The source of a scene: units, constants, the tick, the functions of its header, its self-test.

In C11 and in C++17; every name of its header carries the scene's prefix. Functions of the units
that this scene does not call are left out.
"""

import re

from springpot.codegen.emit.c_text import (
    COLUMNS,
    drop_unused,
    has_block,
    render_block,
    render_template,
    scope_to_scene,
    split_blocks,
    wrap_code,
)
from springpot.codegen.emit.golden import LEG_TICKS, golden_arrays, golden_places
from springpot.codegen.emit.header import apply_prefix, read_unit_blocks, state_types
from springpot.codegen.literals import c_literal, constant_text
from springpot.codegen.plan import Plan, list_headers, list_stages
from springpot.codegen.stages.stage import RegressorStage, Stage
from springpot.runtime_c.paths import INCLUDE

ABI_VERSION = 1
_MANIFEST = "@MANIFEST@"  # the short manifest replaces it at the end
LATCHED_S = 0.05  # after which a latched force is 0


def render_step(plan: Plan) -> str:
    """Return the functions of a scene: its step, and what the header declares."""
    in_order = list_stages(plan)
    model = [stage for stage in in_order if stage is not plan.velocity]
    restarting = "\n".join(render_block(stage, "restart") for stage in in_order)
    ticking = "\n".join(render_block(stage, "advance") for stage in model)
    if plan.features is not None and plan.regressor is not None:
        ticking += render_block(plan.features, "features") + render_block(plan.regressor, "force")
    terms = _force_terms(plan)
    placed = plan.passive and plan.passive.placed
    return render_template(
        "scene.c.j2",
        plan=plan,
        stages=in_order,
        model=model,
        block_text=render_block,
        has_block=has_block,
        terms=terms,
        restart_needs=_find_used_depths(plan, restarting, always=False),
        tick_needs=_find_used_depths(plan, f"{ticking}\n{' '.join(terms)}", always=plan.contact),
        start_m=[c_literal(plan.dtype(at)) for at in placed.start_m] if placed else [],
        abi_version=ABI_VERSION,
        manifest=_MANIFEST,
    )


def _force_terms(plan: Plan) -> list[str]:
    """List the C variables whose sum is the model's force: each part of the model declares one."""
    terms = []
    if plan.passive is not None:
        terms.append(f"{plan.passive.follows}_passive_n")
    if plan.features is not None and plan.regressor is not None:
        terms.append("model_n")
    if plan.excess is not None:
        terms.append("(penetration_passive_n - clipped_passive_n)")
    return terms


def _find_used_depths(plan: Plan, text: str, always: bool) -> dict[str, bool]:
    """Find which of position, penetration and clipped depth the parts' C reads; no others stay."""
    clipped, penetration = _mentions("clipped_m", text), _mentions("penetration_m", text)
    used = clipped or penetration
    return {
        "clipped": clipped,
        "penetration": penetration or always or (used and plan.contact),
        "position": used or _mentions("position_m", text),
    }


def _mentions(name: str, text: str) -> bool:
    return re.search(rf"\b{name}\b", text) is not None


def render_source(plan: Plan, manifest: str, selftest: bool = True) -> str:
    """C of the whole scene, in the order of a tick; manifest: JSON that the image holds."""
    prefix, in_header = plan.scene.runtime.prefix, state_types(plan)
    # sp_real.h without its type, which the C writes as float or double.
    blocks_of_real = split_blocks((INCLUDE / plan.real / "sp_real.h").read_text(encoding="utf-8"))
    parts = [_heading("sp_real.h")]
    parts += [
        "\n\n".join(
            real_block
            for real_block in blocks_of_real
            if "#define sp_" in real_block or "_MAX" in real_block
        )
    ]
    for header in list_headers(plan):
        blocks = (block for block in read_unit_blocks(header) if block not in in_header)
        parts += [_heading(header), *blocks]
    n_units = len(parts)
    parts += [_heading("constants of this scene"), *split_blocks(render_constants(plan))]
    # The two stages of the excess share their tables.
    holders: list[Stage | RegressorStage] = [*list_stages(plan)]
    holders = [one for one in holders if not plan.excess or one is not plan.excess[1]]
    holders += [plan.regressor] if plan.regressor is not None else []
    tables = [line for one in holders for line in ("", *one.tables())]
    parts += split_blocks("\n".join(tables))
    parts += [_heading("the tick, and the functions of the header")]
    parts += split_blocks(render_step(plan))
    if selftest:
        parts += [_heading("self-test"), "#ifndef SP_NO_SELFTEST /* to leave it out of an image */"]
        parts += ["\n".join(golden_arrays(plan)), *split_blocks(_render_selftest(plan)), "#endif"]
    parts[n_units:] = scope_to_scene(parts[n_units:])
    text = render_template(
        "source.c.j2",
        plan=plan,
        prefix=prefix,
        forest="sp_forest.h" in list_headers(plan),
        body="\n\n".join(drop_unused(parts)),
    )
    escaped = manifest.replace("\\", "\\\\").replace('"', '\\"')
    return wrap_code(apply_prefix(text, prefix, plan.real)).replace(_MANIFEST, escaped)


def render_constants(plan: Plan) -> str:
    """C constants that the scene itself fixes: limits, gains, rates."""
    configs = {
        "silence": plan.silence,
        "guard": plan.guard,
        "range": plan.range,
        "output": plan.output,
        "couple": plan.couple,
        "onset_per_m": plan.onset_per_m,
        "fade_per_m": plan.fade_per_m,
        "smooth_alpha": plan.smooth_alpha,
    }
    return "\n".join(constant_text(*item) for item in configs.items() if item[1] is not None)


def _render_selftest(plan: Plan) -> str:
    """Render the self-test: the stored motion, its forces, and a probe of the features' sums."""
    return render_template(
        "selftest.c.j2",
        plan=plan,
        block_text=render_block,
        probe=None if plan.features is None else plan.features.probe(),
        bits="uint32_t" if plan.real == "float" else "uint64_t",
        places=[
            (tick, [c_literal(plan.dtype(at)) for at in place_m])
            for tick, place_m in golden_places(plan)
        ],
        deep=3 * LEG_TICKS,
        latched_s=c_literal(plan.dtype(plan.watchdog_s + 2.0 * plan.dt_s + LATCHED_S)),
    )


def _heading(title: str) -> str:
    return f"/* {'-' * (COLUMNS - 7 - len(title))} {title} */"
