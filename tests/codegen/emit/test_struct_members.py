"""Constants are initialised by position: in the order of the C struct, whose members they name."""

import re

from support.c.golden_forces import model
from support.c.single import plan_of

from springpot.codegen.emit.files import regressor_tables, stage_tables
from springpot.codegen.emit.glue import constants
from springpot.codegen.literals import members_text
from springpot.runtime_c.paths import SOURCE

_CONSTANT = re.compile(r"^static const (\w+) \w+ = \{\n((?:    .*/\* \w+ \*/\n)+)\};", re.MULTILINE)
STRUCTS = {
    "sp_silence_config",
    "sp_guard_config",
    "sp_range_config",
    "sp_output_config",
    "sp_couple_config",
    "sp_hammerstein_config",
    "sp_hammerstein_tables",
    "sp_forest",
}


def members_of(struct: str) -> list[str]:
    """Members in the order of the C."""
    for header in sorted(SOURCE.glob("*.h")):
        text = header.read_text()
        if (end := text.find(f"}} {struct};")) >= 0:
            begin = text.rindex("typedef struct {", 0, end)
            return re.findall(r"(\w+)(?:\[\d+\])?;", text[begin:end])
    raise AssertionError(f"no header defines {struct}")


def test_every_struct_has_its_members_in_order() -> None:
    plan = plan_of("hybrid", model("hybrid"), "float32", "tool")
    text = "\n".join([constants(plan), *stage_tables(plan), *regressor_tables(plan)])
    found = dict(_CONSTANT.findall(text))
    assert set(found) == STRUCTS
    for struct, lines in found.items():
        assert re.findall(r"/\* (\w+) \*/", lines) == members_of(struct), struct


def test_each_value_names_its_member() -> None:
    assert members_text("range", "sp_range_config", {"min_m": "0.0f", "max_m": "0.01f"}) == (
        "static const sp_range_config range = {\n    0.0f,  /* min_m */\n    0.01f, /* max_m */\n};"
    )
