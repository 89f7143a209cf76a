/* Stop operators (Prandtl-Ishlinskii): P(u) - P(p). The play p follows u and stays within `radius`
 * of it. The loss does not depend on the rate; with a P that never falls no energy is gained. */
#ifndef SP_STOPS_H
#define SP_STOPS_H

#include "sp_real.h"

static inline sp_real sp_stops_play(sp_real play, sp_real u, sp_real radius)
{
    const sp_real low = u - radius;
    const sp_real high = u + radius;
    const sp_real raised = play > low ? play : low;
    return raised < high ? raised : high;
}

#endif
