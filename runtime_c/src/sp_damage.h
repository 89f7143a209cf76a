/* Damage: what was pressed deeper before is softer (Mullins's effect).
 *
 *     force = g(v) (v/M)^q,   q = 1 or 3,   M the largest v so far, which heals towards v
 *
 * with v = max(u, 0), u the share of the trained depth. M rises only at v = M, where the force is
 * g(v), and falls only with the stored energy: none is given (docs/explanation/model.md). */
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

/* (v/M) of one curve; deepest: its M. healed: the share of M - v that this tick takes off M. */
static inline sp_real sp_damage_ratio(sp_real healed, sp_real v, sp_real *deepest)
{
    const sp_real left = *deepest - healed * (*deepest - v);
    if (!(left > v)) {
        *deepest = v;
        return (sp_real)1;
    }
    *deepest = left;
    const sp_real share = v / left;
    return share < (sp_real)1 ? share : (sp_real)1; /* always; for the analyser */
}

/* One tick. The first n_linear of n curves have q = 1, the others 3; values: of the curves at u.
 * Returns the sum, N. */
static inline sp_real sp_damage(const sp_real *healed, uint32_t n_linear, uint32_t n, sp_real u,
                                const sp_real *values, sp_real *deepest)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        const sp_real share = sp_damage_ratio(healed[i], v, &deepest[i]);
        sum_n += values[i] * (i < n_linear ? share : share * share * share);
    }
    return sum_n;
}

#endif
