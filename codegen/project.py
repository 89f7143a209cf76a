"""What stands around the scene's C: self-test, example program, Makefile for a build by hand."""

from importlib.resources import files

from springpot.codegen.glue import prefixed
from springpot.codegen.plan import Plan


def selftest_source(plan: Plan) -> str:
    """C source of sp_selftest: golden vectors through the C, bits compared."""
    velocity = "from_bits(golden_velocity[i])" if plan.needs_device_velocity else "(sp_real)0"
    return _filled("selftest.c", plan, VELOCITY=velocity)


def example_main(plan: Plan) -> str:
    """A program that renders positions from its standard input."""
    return _filled("main.c", plan)


def example_makefile(plan: Plan) -> str:
    """Makefile that builds the example and runs the self-test, without Python."""
    return _filled("Makefile", plan)


def _filled(template: str, plan: Plan, **places: str) -> str:
    text = (files("springpot.codegen") / "templates" / template).read_text()
    prefix = plan.scene.runtime.prefix
    facts = {
        "PREFIX": prefix,
        "REAL": plan.real,
        "BITS": "uint32_t" if plan.real == "float" else "uint64_t",
        "DT": repr(plan.dt_s),
        **places,
    }
    for place, value in facts.items():
        text = text.replace(f"@{place}@", value)
    return prefixed(text, prefix) if template.endswith(".c") else text
