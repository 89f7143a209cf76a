/* Stop operators (Prandtl-Ishlinskii): g(u) - g(p), where p, the play, follows u at a distance of
 * at most its radius. Rate-independent loss; with non-negative weights never a gain of energy. */
#ifndef SP_STOPS_H
#define SP_STOPS_H

#include <stdint.h>

#include "sp_real.h"

static inline sp_real sp_stops_play(sp_real play, sp_real u, sp_real radius)
{
    const sp_real low = u - radius;
    const sp_real high = u + radius;
    const sp_real raised = play > low ? play : low;
    return raised < high ? raised : high;
}

/* Sum over the basis of weight (b(u) - b(p)), N. */
static inline sp_real sp_stops_force(const sp_real *weights, const sp_real *basis_u,
                                     const sp_real *basis_p, uint32_t n_basis)
{
    sp_real sum = (sp_real)0;
    for (uint32_t j = 0; j < n_basis; j++) {
        sum += weights[j] * (basis_u[j] - basis_p[j]);
    }
    return sum;
}

#endif
