/* Damage: what was pressed deeper before is softer (Mullins's effect).
 *
 *     force = g(v) (v/M)^q,   q = 1 or 3,   M the largest v so far, which heals towards v
 *
 * with v = u in the object. M rises only with v = M, where the force is g(v), and falls only while
 * the stored energy falls with it: no press gives energy back (docs/explanation/model.md). */
#ifndef SP_DAMAGE_H
#define SP_DAMAGE_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_number.h"

/* It has rested at u for ever, and was never deeper. */
static inline void sp_damage_rest(uint32_t n, sp_real u, sp_real *deepest)
{
    for (uint32_t i = 0; i < n; i++) {
        deepest[i] = u > (sp_real)0 ? u : (sp_real)0;
    }
}

/* Share of one curve. healed: of M - v, in this tick. */
static inline sp_real sp_damage_share(sp_real healed, sp_real v, sp_real *deepest)
{
    const sp_real left = *deepest - healed * (*deepest - v);
    if (!(left > v)) {
        *deepest = v;
        return (sp_real)1;
    }
    *deepest = left;
    const sp_real share = v / left;
    return share < (sp_real)1 ? share : (sp_real)1; /* it is: the analyser sees it so */
}

/* One tick. The first n_linear of n curves have q = 1, the others 3; values: of the curves at u.
 * Returns the sum, N. */
static inline sp_real sp_damage(const sp_real *healed, uint32_t n_linear, uint32_t n, sp_real u,
                                const sp_real *values, sp_real *deepest)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        const sp_real share = sp_damage_share(healed[i], v, &deepest[i]);
        sum_n += values[i] * (i < n_linear ? share : share * share * share);
    }
    return sum_n;
}

#endif
