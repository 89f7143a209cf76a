#include "random_presses.h"

#include <math.h>
#include <string.h>

#include "sp_notes.h"

/* xorshift64* (Vigna 2016). */
static uint64_t random_bits(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 2685821657736338717u;
}

static double random_share(uint64_t *state)
{
    return (double)(random_bits(state) >> 11) * 0x1p-53;
}

/* A smooth stroke of the hand: from one place to another in so many ticks. */
typedef struct {
    double from;
    double to;
    uint64_t ticks;
    uint64_t at;
} stroke;

static double stroke_next(stroke *s, double dt_s, uint64_t *random)
{
    if (s->at >= s->ticks) {
        s->from = s->to;
        s->to = random_share(random) < 0.4 ? -0.2 : random_share(random);
        /* 0.1 to 2 s, short ones as often as long ones */
        s->ticks = 1 + (uint64_t)(0.1 * pow(20.0, random_share(random)) / dt_s);
        s->at = 0;
    }
    const double t = (double)++s->at / (double)s->ticks;
    return s->from + (s->to - s->from) * t * t * (3.0 - 2.0 * t);
}

int press_at_random(const sp_closed_loop_scene *scene, sim_tool *hand, uint64_t ticks, double dt_s,
                    double reach_m, uint64_t seed, random_presses *found)
{
    int (*step)(void *, sp_real, sp_real, sp_real *);
    memcpy(&step, &scene->step, sizeof step);
    uint64_t random = seed * 2 + 1;
    stroke moving = {.from = -0.2, .to = -0.2};
    double seen_m, seen_mps, before_m, here_m, true_mps;
    double taken_j = 0.0, sums_n[2] = {0.0, 0.0};
    uint64_t counts[2] = {0, 0};
    int pressing = 0;
    memset(found, 0, sizeof *found);
    sim_tool_truth(hand, &seen_m, &seen_mps);
    before_m = seen_m;
    for (uint64_t i = 0; i < ticks; i++) {
        sp_real force = 0;
        const int notes = step(scene->state, (sp_real)seen_m, (sp_real)seen_mps, &force);
        found->latched += (notes & SP_NOTE_LATCHED) ? 1 : 0;
        found->not_finite += isfinite(force) ? 0 : 1;
        const double acting_n = isfinite(force) ? (double)force : 0.0;
        const double intended_m = reach_m * stroke_next(&moving, dt_s, &random);
        const int status = sim_tool_step(hand, dt_s, intended_m, acting_n, &seen_m, &seen_mps);
        if (status != SIM_OK) {
            return status;
        }
        sim_tool_truth(hand, &here_m, &true_mps);
        taken_j += acting_n * (here_m - before_m);
        before_m = here_m;
        if (here_m > 0.0) {
            pressing = 1;
            const int last = i >= ticks - ticks / 10;
            if (last || i < ticks / 10) {
                sums_n[last] += acting_n;
                counts[last]++;
            }
        } else if (pressing) {
            found->presses++;
            found->max_returned_j = fmax(found->max_returned_j, -taken_j);
            found->max_taken_j = fmax(found->max_taken_j, taken_j);
            pressing = 0;
            taken_j = 0.0;
        }
        found->deepest_m = fmax(found->deepest_m, here_m);
    }
    found->first_n = counts[0] ? sums_n[0] / (double)counts[0] : 0.0;
    found->last_n = counts[1] ? sums_n[1] / (double)counts[1] : 0.0;
    return 0;
}
