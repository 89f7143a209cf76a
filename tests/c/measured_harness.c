/* Poles over measured time steps, many ticks at a call, for tests. */
#include <stdint.h>

#include "sp_measured.h"
#include "sp_slow_poles.h"

void phis(const sp_real *u, uint32_t n, sp_real *phi);
void measured_poles(const sp_real *per_tau, uint32_t n_poles, uint32_t n_fast, uint32_t n,
                    const sp_real *dt_s, const sp_real *depth_m, double *slow, sp_real *states);

void phis(const sp_real *u, uint32_t n, sp_real *phi)
{
    for (uint32_t i = 0; i < n; i++) {
        phi[i] = sp_measured_phi(u[i]);
    }
}

/* states: [n][n_poles], the first row given: states at depth_m[0]. */
void measured_poles(const sp_real *per_tau, uint32_t n_poles, uint32_t n_fast, uint32_t n,
                    const sp_real *dt_s, const sp_real *depth_m, double *slow, sp_real *states)
{
    sp_real one[64];
    for (uint32_t i = 0; i < 64; i++) {
        one[i] = (sp_real)1;
    }
    for (uint32_t t = 1; t < n; t++) {
        const sp_real rise = depth_m[t] - depth_m[t - 1];
        sp_real *now = states + t * n_poles;
        for (uint32_t i = 0; i < n_fast; i++) {
            now[i] = states[(t - 1) * n_poles + i];
        }
        sp_measured_shared(per_tau, one, n_fast, dt_s[t], rise, now);
        sp_measured_slow(per_tau + n_fast, one, n_poles - n_fast, dt_s[t], rise, slow,
                         now + n_fast);
    }
}
