/* Monotone bases of the depth u (0 at the least trained position, 1 at the greatest), for
 * sp_hammerstein.h: with non-negative weights every sum of them is a monotone spring. */
#ifndef SP_BASIS_H
#define SP_BASIS_H

#include <stdint.h>

#include "sp_real.h"

enum { SP_BASIS_POWERS = 3, SP_BASIS_RAMPS = 8 };

/* u, u^2, u^3; 0 below u = 0. */
static inline void sp_basis_powers(sp_real u, sp_real *b)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    b[0] = v;
    b[1] = v * v;
    b[2] = b[1] * v;
}

/* Ramp j rises from u = j/8 on and saturates at (j + 1)/8; the last one does not. */
static inline void sp_basis_ramps(sp_real u, sp_real *b)
{
    const sp_real width = (sp_real)1 / (sp_real)SP_BASIS_RAMPS;
    for (uint32_t j = 0; j < SP_BASIS_RAMPS; j++) {
        const sp_real above = u - (sp_real)j * width;
        const sp_real risen = above > (sp_real)0 ? above : (sp_real)0;
        b[j] = j + 1 < SP_BASIS_RAMPS && risen > width ? width : risen;
    }
}

#endif
