"""C out of templates: the scene's own, and those that the stages of a model bring."""

import re
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from springpot.codegen.literals import literal
from springpot.codegen.plan.plan import Plan
from springpot.codegen.plan.units import stages
from springpot.codegen.stages.stage import RegressorStage, Stage

ABI_VERSION = 1
_TEMPLATES = Environment(
    loader=PackageLoader("springpot.codegen.emit", "templates"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


def rendered(template: str, **context: Any) -> str:
    """Fill in a file of codegen/emit/templates."""
    return _TEMPLATES.get_template(template).render(literal=literal, **context)


def block_text(stage: Stage | RegressorStage, block: str) -> str:
    """Fill in one block of a stage's own template: lines of C, without the last line's end."""
    template = _TEMPLATES.from_string(stage.code)
    context = template.new_context({"stage": stage, "literal": literal})
    return "".join(template.blocks[block](context)).rstrip("\n")


def has_block(stage: Stage | RegressorStage, block: str) -> bool:
    """Whether a stage's template has that block."""
    return block in _TEMPLATES.from_string(stage.code).blocks


def step_functions(plan: Plan, manifest: str) -> str:
    """The functions of a scene: its step, and what the header declares.

    manifest: JSON that the image holds.
    """
    in_order = stages(plan)
    model = [stage for stage in in_order if stage is not plan.velocity]
    restarting = "\n".join(block_text(stage, "restart") for stage in in_order)
    ticking = "\n".join(block_text(stage, "advance") for stage in model)
    if plan.features is not None and plan.regressor is not None:
        ticking += block_text(plan.features, "features") + block_text(plan.regressor, "force")
    terms = _terms(plan)
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
        start_m=_start_m(plan),
        abi_version=ABI_VERSION,
        manifest=manifest.replace("\\", "\\\\").replace('"', '\\"'),
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


def _start_m(plan: Plan) -> list[str]:
    """Where the object is felt until a place is chosen, x and y; empty without places."""
    if plan.passive is None or plan.passive.placed is None:
        return []
    return [literal(plan.dtype(at)) for at in plan.passive.placed.start_m]
