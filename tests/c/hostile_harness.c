/* Any order of good, false, missing and late samples through a scene: what a hand is owed of every
 * call is counted where it is broken. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "sp_notes.h"
#include "sp_real.h"

typedef int (*step_function)(void *, sp_real, sp_real, sp_real *);
typedef int (*idle_function)(void *, sp_real, sp_real *);
typedef void (*reset_function)(void *);

typedef struct {
    void *step, *idle, *reset, *state;
    double dt_s, depth_m, watchdog_s;
    double min_n, max_n, slew_n;
    int32_t surface; /* positions at or below 0 are free air */
} hostile_scene;

typedef struct {
    uint64_t not_allowed;   /* not finite, or outside [min_n, max_n] */
    uint64_t grown;         /* by more than slew_n above what was given before */
    uint64_t risen;         /* in a call without a good sample */
    uint64_t in_air;        /* a force in air, but for a lone sample that is rejected */
    uint64_t still_latched; /* a force 10 ms after the watchdog fell, or one that grew since */
    uint64_t silent_on;     /* calls beyond the watchdog's time without a good sample, unlatched */
    uint64_t latches, calls_held, pressed;
} hostile_found;

void hostile(const hostile_scene *scene, uint64_t calls, uint64_t seed, hostile_found *found);

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

static sp_real random_pattern(uint64_t *random)
{
    const uint64_t bits = random_bits(random);
    sp_real pattern;
    memcpy(&pattern, (const char *)&bits + (sizeof bits - sizeof pattern), sizeof pattern);
    return pattern;
}

/* The hand's motion, and what is wrong with the device: stretches of the one and of the other. */
typedef struct {
    uint64_t random, ticks, at;
    double from, to, position, offset;
    double false_share, lost_share, zero_share;
    int patterns;
} motion;

static void next_stretch(motion *m)
{
    m->from = m->to;
    m->to = random_share(&m->random) < 0.3 ? -0.2 : 1.3 * random_share(&m->random);
    m->ticks = 5 + (uint64_t)(2.0 * pow(500.0, random_share(&m->random))); /* 7 ms to 1 s */
    m->at = 0;
    const double what = random_share(&m->random);
    m->patterns = what < 0.05;
    m->false_share = what < 0.4 ? 0.0 : 0.2 * random_share(&m->random);
    m->lost_share = what < 0.4 ? 0.0 : 0.2 * random_share(&m->random);
    m->zero_share = what < 0.8 ? 0.0 : 0.3;
}

static sp_real next_sample(motion *m, double depth_m)
{
    if (m->at >= m->ticks) {
        next_stretch(m);
    }
    const double t = (double)++m->at / (double)m->ticks;
    m->position = depth_m * (m->from + (m->to - m->from) * t * t * (3.0 - 2.0 * t)) + m->offset;
    if (m->patterns) {
        return random_pattern(&m->random);
    }
    const double what = random_share(&m->random);
    if (what < m->zero_share) {
        return (sp_real)0; /* an estimate that is not valid */
    }
    if (what > 0.9999) {
        m->offset = 0.5 * depth_m * (random_share(&m->random) - 0.5); /* a step that stays */
    }
    if (random_share(&m->random) >= m->false_share) {
        return (sp_real)m->position;
    }
    const double kind = random_share(&m->random);
    return kind < 0.3   ? (sp_real)NAN
           : kind < 0.4 ? (sp_real)INFINITY
                        : (sp_real)(m->position + 0.01 * (random_share(&m->random) - 0.5));
}

typedef struct {
    sp_real last_n;
    double silent_s, latched_s;
    uint32_t latched;
} watched;

/* One call's answer; sampled: it had a sample, at x. dt_s: that it lasted. */
static void judge(const hostile_scene *scene, hostile_found *found, watched *last, int notes,
                  sp_real force_n, int sampled, sp_real x, double dt_s)
{
    const sp_real slew_n = (sp_real)scene->slew_n;
    const sp_real size_n = sp_abs(force_n), before_n = sp_abs(last->last_n);
    const int taken = sampled && !(notes & SP_NOTE_HELD);
    const int plausible = sampled && x == x && sp_abs(x) <= (sp_real)scene->depth_m;
    found->not_allowed += !((double)force_n >= scene->min_n && (double)force_n <= scene->max_n);
    found->grown += !(size_n <= before_n + slew_n);
    found->risen += !taken && !(size_n <= before_n);
    const int lone = !taken && last->silent_s == 0.0;
    found->in_air += scene->surface && plausible && x <= (sp_real)0 && !lone &&
                     !(notes & SP_NOTE_LATCHED) && force_n != (sp_real)0;
    found->calls_held += !taken;
    found->pressed += size_n > (sp_real)0;
    last->silent_s = taken ? 0.0 : last->silent_s + dt_s;
    found->silent_on +=
        !(notes & SP_NOTE_LATCHED) && last->silent_s > scene->watchdog_s + 1.001 * scene->dt_s;
    if (notes & SP_NOTE_LATCHED) {
        found->latches += !last->latched;
        found->still_latched += (last->latched && size_n > before_n) ||
                                (last->latched_s > 0.01 && force_n != (sp_real)0);
        last->latched_s += last->latched ? dt_s : 0.0; /* of the call that latched only a part */
    } else {
        last->latched_s = 0.0;
    }
    last->latched = (notes & SP_NOTE_LATCHED) != 0;
    last->last_n = force_n;
}

void hostile(const hostile_scene *scene, uint64_t calls, uint64_t seed, hostile_found *found)
{
    step_function step;
    idle_function idle;
    reset_function reset;
    memcpy(&step, &scene->step, sizeof step);
    memcpy(&idle, &scene->idle, sizeof idle);
    memcpy(&reset, &scene->reset, sizeof reset);
    motion m = {.random = seed * 2 + 1, .from = -0.2, .to = -0.2};
    watched last = {0};
    for (uint64_t i = 0; i < calls; i++) {
        sp_real force_n = (sp_real)0;
        const sp_real x = next_sample(&m, scene->depth_m);
        const sp_real v = m.patterns ? random_pattern(&m.random) : (sp_real)0.1;
        const double how = random_share(&m.random);
        double dt_s = scene->dt_s;
        int notes, sampled = 1;
        if (how < m.lost_share) {
            const double kind = random_share(&m.random);
            dt_s *= kind < 0.9     ? 1.0
                    : kind < 0.999 ? 30.0 * random_share(&m.random)
                                   : pow(10.0, 37.0 * random_share(&m.random));
            sampled = 0;
            notes = idle(scene->state, (sp_real)dt_s, &force_n);
        } else {
            notes = step(scene->state, x, v, &force_n);
        }
        judge(scene, found, &last, notes, force_n, sampled, x, dt_s);
        if (last.latched_s > 0.03 || how > 0.99997) {
            reset(scene->state);
            last.silent_s = 0.0;
        }
    }
}
