/* Stop operators (Prandtl-Ishlinskii): P(u) - P(p), where p, the play, follows u at a distance of
 * at most its radius. Rate-independent loss; with a P that never falls, never a gain of energy. */
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
