/* Bit patterns of a float through guard, velocity guard, clamp: all 2^32 with the argument 1, every
 * 99 991st by default. Doubles take the same patterns as their upper half. */
#define OWN_MAIN
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "sp_guard.h"
#include "sp_output.h"

static const sp_guard_config guard = {.max_step_m = (sp_real)0.001,
                                      .min_m = (sp_real)-10,
                                      .max_m = (sp_real)0.1,
                                      .air_m = (sp_real)-10,
                                      .resync_ticks = 3};
static const sp_output_config output = {.min_n = (sp_real)0,
                                        .max_n = (sp_real)12,
                                        .slew_n = (sp_real)3,
                                        .ramp_per_tick = (sp_real)0.25,
                                        .latch_fall_n = (sp_real)1.5};

static sp_real pattern(uint32_t bits)
{
    sp_real value;
    if (sizeof(sp_real) == sizeof bits) {
        memcpy(&value, &bits, sizeof value);
    } else {
        const uint64_t wide = (uint64_t)bits << 32 | bits;
        memcpy(&value, &wide, sizeof value);
    }
    return value;
}

/* 1 where any pattern gets past the guards or the clamp. */
static int gets_past(uint32_t bits)
{
    const sp_real x = pattern(bits);
    sp_guard_state fresh = {0};
    sp_guard_state held = {.last_good_m = (sp_real)0.005, .started = 1};
    sp_output_state rest = {.ramp = (sp_real)1};
    sp_output_state pressed = {.ramp = (sp_real)1, .last_n = (sp_real)11};
    sp_output_state late = {.ramp = (sp_real)1, .last_n = (sp_real)6};
    int notes = 0;
    const sp_real first_m = sp_guard_accept(&guard, &fresh, (sp_real)1, x, &notes);
    const sp_real next_m = sp_guard_accept(&guard, &held, (sp_real)1, x, &notes);
    const sp_real slow_n = sp_output_limit(&output, &rest, (sp_real)1, x, &notes);
    const sp_real fast_n = sp_output_limit(&output, &pressed, (sp_real)1, x, &notes);
    const sp_real late_n = sp_output_limit(&output, &late, (sp_real)1, x, &notes);
    return !(first_m >= guard.min_m && first_m <= guard.max_m) ||
           !(sp_abs(next_m - (sp_real)0.005) <= guard.max_step_m) ||
           !(slow_n >= (sp_real)0 && slow_n <= (sp_real)3) ||
           !(fast_n >= (sp_real)0 && fast_n <= (sp_real)12) ||
           !(late_n >= (sp_real)0 && late_n <= (sp_real)9) ||
           (first_m != (sp_real)0 && sp_abs(first_m) < SP_FLUSH_BELOW);
}

int main(int argc, char **argv)
{
    const uint64_t stride = argc > 1 ? strtoull(argv[1], NULL, 10) : 99991;
    uint64_t past = 0;
    for (uint64_t bits = 0; bits <= UINT32_MAX; bits += stride) {
        past += gets_past((uint32_t)bits) ? 1 : 0;
    }
    CHECK(past == 0);
    return failed;
}
