/* Links without hardware: a simulated hand, and a recording. */
#include <math.h>

#include "sim.h"
#include "sp_link.h"

/* springpot declarations begin */
/* A simulated hand (runtime_c/sim) that holds the device and presses to and fro: it intends to be
 * at depth_m / 2 * (1 - cos(2 pi frequency_hz t)). tool: a sim_tool, initialised. */
uint32_t sp_link_sim_size(void);
sp_link *sp_link_sim_init(void *memory, void *tool, double dt_s, double depth_m,
                          double frequency_hz);

/* n samples that somebody recorded, one a tick. */
uint32_t sp_link_replay_size(void);
sp_link *sp_link_replay_init(void *memory, uint64_t n, const double *position_m,
                             const double *velocity_mps);
/* springpot declarations end */

typedef struct {
    sp_link link;
    sim_tool *tool;
    double dt_s;
    double depth_m;
    double turn_rps; /* rad/s */
    uint64_t ticks;
    double force_n;
} hand;

typedef struct {
    sp_link link;
    uint64_t n;
    uint64_t at;
    const double *position_m;
    const double *velocity_mps;
} replay;

static void reset_nothing(sp_link *link, uint64_t now_ns)
{
    (void)link;
    (void)now_ns;
}

/* A simulated hand's sample: it presses along a cosine between 0 and depth_m, against the force
 * that was sent last. */
static int read_hand(sp_link *link, uint64_t now_ns, sp_motion *motion, uint32_t capacity)
{
    (void)capacity;
    hand *self = (hand *)link;
    const double time_s = (double)++self->ticks * self->dt_s;
    const double intended_m = self->depth_m / 2 * (1 - cos(self->turn_rps * time_s));
    (void)sim_tool_step(self->tool, self->dt_s, intended_m, self->force_n, &motion->position_m,
                        &motion->velocity_mps);
    motion->measured_n = (double)NAN;
    motion->arrived_ns = now_ns;
    link->samples++;
    return 1;
}

static int write_hand(sp_link *link, uint64_t now_ns, double force_n)
{
    ((hand *)link)->force_n = force_n;
    (void)now_ns;
    return 0;
}

uint32_t sp_link_sim_size(void)
{
    return (uint32_t)sizeof(hand);
}

/* Make the link of a simulated hand in the caller's memory. */
sp_link *sp_link_sim_init(void *memory, void *tool, double dt_s, double depth_m,
                          double frequency_hz)
{
    hand *self = (hand *)memory;
    *self = (hand){.link = {.fd = -1,
                            .ready = 1,
                            .read = read_hand,
                            .write = write_hand,
                            .reset = reset_nothing},
                   .tool = (sim_tool *)tool,
                   .dt_s = dt_s,
                   .depth_m = depth_m,
                   .turn_rps = 6.283185307179586 * frequency_hz};
    return &self->link;
}

/* The next sample of a recorded motion; nothing acts on it. */
static int read_replay(sp_link *link, uint64_t now_ns, sp_motion *motion, uint32_t capacity)
{
    (void)capacity;
    replay *self = (replay *)link;
    if (self->at == self->n) {
        return SP_LINK_ENDED;
    }
    motion->position_m = self->position_m[self->at];
    motion->velocity_mps = self->velocity_mps[self->at];
    motion->measured_n = (double)NAN;
    motion->arrived_ns = now_ns;
    self->at++;
    link->samples++;
    return 1;
}

static int write_replay(sp_link *link, uint64_t now_ns, double force_n)
{
    (void)link;
    (void)now_ns;
    (void)force_n;
    return 0;
}

uint32_t sp_link_replay_size(void)
{
    return (uint32_t)sizeof(replay);
}

/* Make the link that replays n recorded samples. */
sp_link *sp_link_replay_init(void *memory, uint64_t n, const double *position_m,
                             const double *velocity_mps)
{
    replay *self = (replay *)memory;
    *self = (replay){.link = {.fd = -1,
                              .ready = 1,
                              .read = read_replay,
                              .write = write_replay,
                              .reset = reset_nothing},
                     .n = n,
                     .position_m = position_m,
                     .velocity_mps = velocity_mps};
    return &self->link;
}
