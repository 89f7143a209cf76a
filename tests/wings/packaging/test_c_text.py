"""Text of C: what nothing calls is left out."""

from springpot.host.wings.packaging.c_blocks import top_level_blocks, without_unused

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
