#include "sp_closed_loop.h"

#include <math.h>
#include <string.h>

#include "sp_notes.h"

enum { LATCHED = SP_NOTE_LATCHED };

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

typedef struct {
    step_function step;
    idle_function idle;
    reset_function reset;
    void *state;
} calls;

static calls calls_of(const sp_closed_loop_scene *scene)
{
    calls found;
    memcpy(&found.step, &scene->step, sizeof found.step);
    memcpy(&found.idle, &scene->idle, sizeof found.idle);
    memcpy(&found.reset, &scene->reset, sizeof found.reset);
    found.state = scene->state;
    return found;
}

typedef struct {
    sp_real position_m, velocity_mps;
    int come;
} sample;

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

int64_t sp_closed_loop_run(const sp_closed_loop_scene *scene, sim_tool *hand, uint32_t n,
                           const sp_closed_loop_scenario *scenario,
                           const sp_closed_loop_trace *trace)
{
    const calls call = calls_of(scene);
    int64_t not_finite = 0;
    double seen_m, seen_mps;
    sample late = {0};
    sp_real force = 0;
    sim_tool_truth(hand, &seen_m, &seen_mps);
    for (uint32_t i = 0; i < n; i++) {
        const sample now = {(sp_real)(seen_m + scenario->error_m[i]), (sp_real)seen_mps, 1};
        sim_tool_truth(hand, &trace->position_m[i], &trace->velocity_mps[i]);
        trace->seen_m[i] = (double)now.position_m;
        trace->seen_mps[i] = (double)now.velocity_mps;
        if (scenario->dropped[i] == SP_CLOSED_LOOP_LATE) {
            trace->notes[i] = SP_NOTE_HELD; /* the last force is sent again, and the tick is owed */
            late = now;
        } else if (scenario->dropped[i] == SP_CLOSED_LOOP_LOST) {
            trace->notes[i] = call.idle(call.state, (sp_real)scenario->dt_s[i], &force);
        } else {
            if (late.come) {
                (void)call.step(call.state, late.position_m, late.velocity_mps, &force);
                late.come = 0;
            }
            trace->notes[i] = call.step(call.state, now.position_m, now.velocity_mps, &force);
        }
        trace->force_n[i] = (double)force;
        const double acting_n = isfinite(force) ? (double)force : 0.0;
        not_finite += isfinite(force) ? 0 : 1;
        const int status = isnan(scenario->push_n[i])
                               ? sim_tool_step(hand, scenario->dt_s[i], scenario->intended_m[i],
                                               acting_n, &seen_m, &seen_mps)
                               : sim_tool_push(hand, scenario->dt_s[i], scenario->push_n[i],
                                               acting_n, &seen_m, &seen_mps);
        if (status != SIM_OK) {
            return status;
        }
    }
    return not_finite;
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

int sp_closed_loop_press(const sp_closed_loop_scene *scene, sim_tool *hand, uint64_t ticks,
                         double dt_s, double reach_m, uint64_t seed, sp_closed_loop_presses *found)
{
    const calls call = calls_of(scene);
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
        const int notes = call.step(call.state, (sp_real)seen_m, (sp_real)seen_mps, &force);
        found->latched += (notes & LATCHED) ? 1 : 0;
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
