/* Damage over a measured time step: see sp_damage.h, sp_measured.h. */
#ifndef SP_DAMAGE_DT_H
#define SP_DAMAGE_DT_H

#include "sp_damage.h"
#include "sp_measured.h"

/* rate: of healing, 1/s, 0 if it never heals. */
static inline sp_real sp_damage_dt(sp_real dt_s, const sp_real *rate, const sp_real *worn,
                                   uint32_t n_linear, uint32_t n, sp_real u, const sp_real *values,
                                   sp_real *deepest)
{
    const sp_real v = u > (sp_real)0 ? u : (sp_real)0;
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        const sp_real least = worn != NULL ? worn[i] : (sp_real)0;
        const sp_real healed = sp_measured_loss(dt_s * rate[i]);
        const sp_real share = sp_damage_share(healed, least, v, &deepest[i]);
        sum_n += values[i] * (i < n_linear ? share : share * share * share);
    }
    return sum_n;
}

#endif
