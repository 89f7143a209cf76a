/* A device that nobody touches: it stays at one depth, whatever force it gets. */
#include <math.h>

#include "sp_link.h"

/* springpot declarations begin */
uint32_t sp_link_still_size(void);
sp_link *sp_link_still_init(void *memory, double depth_m);
/* springpot declarations end */

typedef struct {
    sp_link link;
    double depth_m;
} still;

static int read_still(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity)
{
    (void)capacity;
    *motions = (sp_motion){((still *)link)->depth_m, 0.0, (double)NAN, now_ns};
    link->samples++;
    return 1;
}

static int write_still(sp_link *link, uint64_t now_ns, double force_n)
{
    (void)link;
    (void)now_ns;
    (void)force_n;
    return 0;
}

static void reset_still(sp_link *link, uint64_t now_ns)
{
    (void)link;
    (void)now_ns;
}

uint32_t sp_link_still_size(void)
{
    return (uint32_t)sizeof(still);
}

sp_link *sp_link_still_init(void *memory, double depth_m)
{
    still *self = (still *)memory;
    *self = (still){.link = {.fd = -1,
                             .ready = 1,
                             .read = read_still,
                             .write = write_still,
                             .reset = reset_still},
                    .depth_m = depth_m};
    return &self->link;
}
