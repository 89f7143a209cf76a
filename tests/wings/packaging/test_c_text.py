"""Text of C: what nothing calls is left out, constants stand in the order of their struct."""

import re

from support.c.golden_forces import model
from support.c.single import plan_of

from springpot.codegen.emit.files import regressor_tables, stage_tables
from springpot.codegen.emit.glue import constants
from springpot.host.wings.packaging.c_blocks import code_of, top_level_blocks, without_unused
from springpot.runtime_c.paths import SOURCE

TEXT = """/* A unit { that
 * speaks of braces. */

enum { WIDTH = 4 };

/* Called by `used`. */
static inline int inner(int x)
{
    const char *text = "}";

    return x + WIDTH + text[0];
}

static inline int used(int x)
{
    return inner(x);
}

/* Calls itself a friend of lonely, which nothing else does. */
static inline int lonely_caller(void)
{
    return lonely(1);
}

SP_RARE int lonely(int x)
{
    return used(x);
}

static inline int chosen(void)
{
#if WIDTH
    return 1;
#endif
}

int public_name(int x)
{
    return used(x);
}"""


def test_blocks_end_at_blank_lines_outside_braces() -> None:
    blocks = top_level_blocks(TEXT)
    assert len(blocks) == 8
    assert "\n\n".join(blocks) == TEXT


def test_what_nothing_calls_is_left_out_with_what_only_it_calls() -> None:
    kept = without_unused(top_level_blocks(TEXT))
    text = "\n\n".join(kept)
    assert "lonely" not in text
    assert [name in text for name in ("inner(int", "used(int", "public_name", "WIDTH = 4")] == [
        True
    ] * 4
    assert "chosen" in text, "directives may choose it"
    without_public = without_unused([block for block in kept if "public_name" not in block])
    assert not [block for block in without_public if "inner" in block or "used" in block]


_CONSTANT = re.compile(r"^static const (\w+) \w+ = \{\n((?:    .*/\* \w+ \*/\n)+)\};", re.MULTILINE)
STRUCTS = {
    "sp_silence_config",
    "sp_guard_config",
    "sp_range_config",
    "sp_output_config",
    "sp_couple_config",
    "sp_energy_config",
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
            return re.findall(r"(\w+)(?:\[[^]]+\])?;", code_of(text[begin:end]))
    raise AssertionError(f"no header defines {struct}")


def test_every_struct_has_its_members_in_order() -> None:
    plan = plan_of("hybrid", model("hybrid"), "float32", "tool")
    text = "\n".join([constants(plan), *stage_tables(plan), *regressor_tables(plan)])
    found = dict(_CONSTANT.findall(text))
    assert set(found) == STRUCTS
    for struct, lines in found.items():
        assert re.findall(r"/\* (\w+) \*/", lines) == members_of(struct), struct
