/* Flow over a measured time step: see sp_flow.h, which is exact for any. */
#ifndef SP_FLOW_DT_H
#define SP_FLOW_DT_H

#include "sp_flow.h"

/* rate: (p - 1) rate of each branch, 1/s. */
static inline sp_real sp_flow_dt(sp_real dt_s, const sp_real *rate, const sp_real *force_n,
                                 const uint8_t *function, uint32_t n_cubic, uint32_t n, sp_real u,
                                 sp_real *before, sp_real *h)
{
    sp_real rises[SP_FLOW_FUNCTIONS];
    sp_flow_rises(u, before, rises);
    sp_real sum_n = (sp_real)0;
    for (uint32_t i = 0; i < n; i++) {
        h[i] = sp_flow_next(h[i], rises[function[i]], dt_s * rate[i], i < n_cubic);
        sum_n += force_n[i] * h[i];
    }
    return sum_n;
}

#endif
