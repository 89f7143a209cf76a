"""The generated calls of a loop of three axes: sp_step3 and sp_idle3."""

from springpot.codegen.emit.project import filled
from springpot.codegen.emit.tick import indented
from springpot.codegen.literals import literal
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.passive.lateral import LateralStage
from springpot.codegen.stages.passive.maxwell import MaxwellBranches


def lateral_functions(plan: Plan) -> list[str]:
    """C of a scene with a lateral force; none of another."""
    if plan.lateral is None:
        return []
    return [_functions(plan, plan.lateral)]


def _functions(plan: Plan, lateral: LateralStage) -> str:
    config, placed = lateral.of_one.config, lateral.placed
    begins = placed.begins
    tables = [f"its + {begins['spring']}", f"its + {begins['branches']}"]
    stops = [f"its + {begins['stops']}", "stop_radius"] if config.n_stops else ["NULL", "NULL"]
    steps = lateral.of_one.steps
    slow = [
        line for step in steps if step.double for line in _cleared(step.names.prefix, step.count)
    ]
    stepped = [line for step in steps for line in step.step("lateral", config.n_branches)]
    return filled(
        "lateral.c",
        plan,
        TABLES=", ".join([*tables, *stops]),
        CAPACITY=str(config.n_branches),
        PLAY="state->lateral_play" if config.n_stops else "NULL",
        MATERIALS=str(len(lateral.materials)),
        PIECES=str(config.n_pieces),
        STIFFEST=str(begins["stiffest"]),
        LEAST=literal(placed.least),
        AREAS=str(lateral.areas.shape[1]),
        SLOW="".join(f"{line}\n" for line in indented(indented(slow))),
        RENEW="".join(
            f"        {line}\n" for step in steps for line in _renewed(step, config.n_branches)
        ),
        STEPS="".join(f"{line}\n" for line in indented(indented(stepped))),
    ).rstrip("\n")


def _renewed(step: MaxwellBranches, capacity: int) -> list[str]:
    at = f"r * {capacity}" + (f" + {step.first}" if step.first else "")
    slow = f"state->lateral_{step.names.prefix} + r * {step.count}" if step.double else "NULL"
    return [
        f"sp_drag_renew(renewed, {step.count}, state->lateral_before + {at},",
        f"              state->lateral_held + {at}, {slow});",
    ]


def _cleared(prefix: str, count: int) -> list[str]:
    return [
        f"for (uint32_t i = 0; i < {count}; i++) {{",
        f"    state->lateral_{prefix}[r * {count} + i] = 0.0;",
        "}",
    ]
