/* Damage: an object that was pressed deeper before is softer (Mullins's effect).
 *
 *     force = g(v) (v/M)^q,   q = 1 or 3,   M the largest v so far, which heals towards v
 *
 * with v = max(u, 0) of the normalised depth u. M rises only at v = M, where the force is g(v), and
 * falls only together with the stored energy, so no energy is gained (docs/explanation/model.md).
 */
#ifndef SP_DAMAGE_H
#define SP_DAMAGE_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_number.h"

/* Set the state of an object that has rested at u for a long time and was never deeper. */
static inline void sp_damage_rest(uint32_t n, sp_real u, sp_real *deepest)
{
    for (uint32_t i = 0; i < n; i++) {
        deepest[i] = u > (sp_real)0 ? u : (sp_real)0;
    }
}

/* Update the greatest depth M of one curve and return v/M, the part of its force that damage
 * leaves (Mullins effect). healed: fraction of M - v by which M falls in this tick. */
static inline sp_real sp_damage_ratio(sp_real healed, sp_real v, sp_real *deepest)
{
    const sp_real healed_v = *deepest - healed * (*deepest - v);
    if (!(healed_v > v)) {
        *deepest = v;
        return (sp_real)1;
    }
    *deepest = healed_v;
    const sp_real ratio = v / healed_v;
    return ratio < (sp_real)1 ? ratio : (sp_real)1; /* below 1 anyway: a range for the analyser */
}

/* Force of n damage curves, values (v/M)^q, N, after a tick to depth u: softer below the
 * greatest depth so far. The first n_linear have q = 1, the others 3. */
static inline sp_real sp_damage(const sp_real *healed, uint32_t n_linear, uint32_t n, sp_real u,
                                const sp_real *values, sp_real *deepest)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        const sp_real ratio = sp_damage_ratio(healed[i], v, &deepest[i]);
        sum_n += values[i] * (i < n_linear ? ratio : ratio * ratio * ratio);
    }
    return sum_n;
}

#endif
