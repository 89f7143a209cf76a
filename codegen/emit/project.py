"""C text around the scene: self-test, and templates of an example program and its Makefile."""

import re
from importlib.resources import files

from springpot.codegen.emit.golden import LEG_TICKS, golden_places
from springpot.codegen.literals import literal
from springpot.codegen.plan.plan import Plan
from springpot.codegen.stages.stage import Probe

_PUBLIC = "abi_version|state_size|manifest|init|reset|step|step_dt|run|idle|place|selftest|state"


def prefixed(text: str, prefix: str) -> str:
    """Give the public names of sp.h (and only those) the scene's prefix."""
    return re.sub(rf"\bsp_({_PUBLIC})\b", rf"{prefix}_\1", text)


LATCHED_S = 0.05  # after which a latched force is 0


def selftest_source(plan: Plan) -> str:
    """C source of sp_selftest: golden vectors through the C, bits compared."""
    prefix = plan.scene.runtime.prefix
    headers = [f"{prefix}_golden.h", f"{prefix}_scene.h"]
    headers += [f"{prefix}_tables.h"] if _probe(plan) is not None else []
    includes = "\n".join(f'#include "{header}"' for header in headers)
    return f"#include <stddef.h>\n#include <string.h>\n\n{includes}\n\n{selftest(plan)}"


def selftest(plan: Plan) -> str:
    """C functions of the self-test, without the golden vectors."""
    velocity = "from_bits(golden_velocity[i])" if plan.needs_device_velocity else "(sp_real)0"
    probe = _probe(plan)
    text = (
        ""
        if probe is None
        else filled(
            "probe.c", plan, INPUTS=str(probe.inputs), OUTPUTS=str(probe.outputs), CALL=probe.call
        )
    )
    return filled(
        "selftest.c",
        plan,
        VELOCITY=velocity,
        NAN="0x7fc00000u" if plan.real == "float" else "0x7ff8000000000000u",
        DEEP=str(3 * LEG_TICKS),
        LONG=literal(plan.dtype(plan.watchdog_s + 2.0 * plan.dt_s + LATCHED_S)),
        PROBE=text,
        PLACE="".join(
            f"        if (i == {tick}) {{\n            sp_place(&state, "
            f"{', '.join(literal(plan.dtype(at)) for at in place_m)});\n        }}\n"
            for tick, place_m in golden_places(plan)
        ),
        FIRST="    if (probe_differs()) {\n        return 1;\n    }\n" if probe else "",
    )


def _probe(plan: Plan) -> Probe | None:
    return None if plan.features is None else plan.features.probe()


def filled(
    template: str, plan: Plan, package: str = "springpot.codegen.emit", **places: str
) -> str:
    """Fill in the @PLACES@ of a template of `package`, and in C the scene's prefix."""
    text = (files(package) / "templates" / template).read_text()
    prefix = plan.scene.runtime.prefix
    metadata = {
        "PREFIX": prefix,
        "REAL": plan.real,
        "BITS": "uint32_t" if plan.real == "float" else "uint64_t",
        "DT": repr(plan.dt_s),
        **places,
    }
    for place, value in metadata.items():
        text = text.replace(f"@{place}@", value)
    return prefixed(text, prefix) if template.endswith(".c") else text
