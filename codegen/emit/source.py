"""The source of a scene: units, constants, the tick, the functions of its header, its self-test.

In C11 and in C++17; every name of its header carries the scene's prefix. Functions of the units
that this scene does not call are left out.
"""

import re

from springpot.codegen.emit.c_text import (
    block_text,
    has_block,
    rendered,
    top_level_blocks,
    without_unused,
)
from springpot.codegen.emit.golden import LEG_TICKS, golden_arrays, golden_places
from springpot.codegen.emit.header import named, state_types, unit_blocks
from springpot.codegen.literals import constant_text, literal
from springpot.codegen.plan import Plan, planned_headers, stages
from springpot.codegen.stages.stage import RegressorStage, Stage
from springpot.runtime_c.paths import INCLUDE

ABI_VERSION = 1
_WIDTH = 100
_MANIFEST = "@MANIFEST@"  # the short manifest replaces it at the end
LATCHED_S = 0.05  # after which a latched force is 0


def step_functions(plan: Plan) -> str:
    """The functions of a scene: its step, and what the header declares."""
    in_order = stages(plan)
    model = [stage for stage in in_order if stage is not plan.velocity]
    restarting = "\n".join(block_text(stage, "restart") for stage in in_order)
    ticking = "\n".join(block_text(stage, "advance") for stage in model)
    if plan.features is not None and plan.regressor is not None:
        ticking += block_text(plan.features, "features") + block_text(plan.regressor, "force")
    terms = _terms(plan)
    placed = plan.passive and plan.passive.placed
    return rendered(
        "scene.c.j2",
        plan=plan,
        stages=in_order,
        model=model,
        block_text=block_text,
        has_block=has_block,
        terms=terms,
        restart_needs=_needs(plan, restarting, always=False),
        tick_needs=_needs(plan, f"{ticking}\n{' '.join(terms)}", always=plan.contact),
        start_m=[literal(plan.dtype(at)) for at in placed.start_m] if placed else [],
        abi_version=ABI_VERSION,
        manifest=_MANIFEST,
    )


def _terms(plan: Plan) -> list[str]:
    """What the model's force is the sum of: variables that its parts declare."""
    terms = []
    if plan.passive is not None:
        terms.append(f"{plan.passive.follows}_passive_n")
    if plan.features is not None and plan.regressor is not None:
        terms.append("model_n")
    if plan.excess is not None:
        terms.append("(penetration_passive_n - clipped_passive_n)")
    return terms


def _needs(plan: Plan, text: str, always: bool) -> dict[str, bool]:
    """Which of the depths, and of the position, the C of the parts reads; always: the depth too."""
    clipped, deep = _mentions("clipped", text), _mentions("penetration", text)
    used = clipped or deep
    return {
        "clipped": clipped,
        "penetration": deep or always or (used and plan.contact),
        "position": used or _mentions("position", text),
    }


def _mentions(name: str, text: str) -> bool:
    return re.search(rf"\b{name}\b", text) is not None


def source_text(plan: Plan, manifest: str, selftest: bool = True) -> str:
    """C of the whole scene, in the order of a tick; manifest: JSON that the image holds."""
    prefix, in_header = plan.scene.runtime.prefix, state_types(plan)
    # sp_real.h without its type, which the C writes as float or double.
    blocks_of_real = top_level_blocks((INCLUDE / plan.real / "sp_real.h").read_text())
    parts = [_rule("sp_real.h")]
    parts += ["\n\n".join(its for its in blocks_of_real if "#define sp_" in its or "_MAX" in its)]
    for header in planned_headers(plan):
        blocks = (block for block in unit_blocks(header) if block not in in_header)
        parts += [_rule(header), *blocks]
    parts += [_rule("constants of this scene"), constants(plan)]
    # The two stages of the excess share their tables.
    holders: list[Stage | RegressorStage] = [*stages(plan)]
    holders = [one for one in holders if not plan.excess or one is not plan.excess[1]]
    holders += [plan.regressor] if plan.regressor is not None else []
    tables = [line for one in holders for line in ("", *one.tables())]
    parts += top_level_blocks("\n".join(tables))
    parts += [_rule("the tick, and the functions of the header")]
    parts += top_level_blocks(step_functions(plan))
    if selftest:
        parts += [_rule("self-test"), "#ifndef SP_NO_SELFTEST /* to leave it out of an image */"]
        parts += ["\n".join(golden_arrays(plan)), *top_level_blocks(_selftest(plan)), "#endif"]
    text = rendered(
        "source.c.j2",
        plan=plan,
        prefix=prefix,
        forest="sp_forest.h" in planned_headers(plan),
        body="\n\n".join(without_unused(parts)),
    )
    escaped = manifest.replace("\\", "\\\\").replace('"', '\\"')
    return named(text, prefix, plan.real).replace(_MANIFEST, escaped)


def constants(plan: Plan) -> str:
    """C constants that the scene itself fixes: limits, gains, rates."""
    found = {
        "silence": plan.silence,
        "guard": plan.guard,
        "range": plan.range,
        "output": plan.output,
        "couple": plan.couple,
        "per_onset": plan.per_onset,
        "per_fade": plan.per_fade,
        "max_mps": plan.max_mps if plan.needs_device_velocity else None,
        "smooth_alpha": plan.smooth_alpha,
    }
    return "\n".join(constant_text(*item) for item in found.items() if item[1] is not None)


def _selftest(plan: Plan) -> str:
    return rendered(
        "selftest.c.j2",
        plan=plan,
        block_text=block_text,
        probe=None if plan.features is None else plan.features.probe(),
        bits="uint32_t" if plan.real == "float" else "uint64_t",
        places=[
            (tick, [literal(plan.dtype(at)) for at in place_m])
            for tick, place_m in golden_places(plan)
        ],
        deep=3 * LEG_TICKS,
        latched_s=literal(plan.dtype(plan.watchdog_s + 2.0 * plan.dt_s + LATCHED_S)),
    )


def _rule(title: str) -> str:
    return f"/* {'-' * (_WIDTH - 7 - len(title))} {title} */"
