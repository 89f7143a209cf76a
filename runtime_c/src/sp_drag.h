/* Fresh ground under a tip that slides, and the drag that pays for it.
 *
 * By a way w the share w/c of what each branch has relaxed is renewed, c the width of the contact.
 * What that takes, at most (sp_stored.h), the tool pays for through a spring that it draws along
 * while it touches, and that slips (docs/explanation/passivity.md). */
#ifndef SP_DRAG_H
#define SP_DRAG_H

#include <stddef.h>
#include <stdint.h>

#include "sp_number.h"
#include "sp_stored.h"

typedef struct {
    sp_real width_m;       /* of the contact at u = 1: a chord of a circle, in the mean */
    sp_real stiffness_npm; /* of the spring */
} sp_drag_config;

/* Let the spring slip to where it pays for what is renewed: renewal_j is at most what renewing all
 * of the branches takes, u the share of the depth. Adds its drag; returns the share of branches to
 * renew. */
static inline sp_real sp_drag_slip(const sp_drag_config *config, sp_real *drawn_m, sp_real u,
                                   sp_real renewal_j, sp_real *felt_n)
{
    const sp_real x = sp_abs(drawn_m[0]);
    const sp_real y = sp_abs(drawn_m[1]);
    const sp_real way_m = sp_sqrt(x * x + y * y);
    const sp_real width_m = config->width_m * sp_sqrt(u > (sp_real)0 ? u : (sp_real)0);
    const sp_real takes_j = sp_bounded(renewal_j);
    const sp_real most_j = config->stiffness_npm * width_m * way_m;
    sp_real renewed = (sp_real)0;
    if (width_m > SP_SMALLEST && most_j > SP_SMALLEST && most_j > takes_j) {
        /* The drag is takes_j / width_m, N: stiffness_npm times what stays drawn. */
        const sp_real part = takes_j > (sp_real)0 ? takes_j / most_j : (sp_real)0;
        const sp_real stays = part < (sp_real)1 ? part : (sp_real)1;
        const sp_real share = (way_m - stays * way_m) / width_m;
        renewed = share < SP_STORED_RENEWED ? share : SP_STORED_RENEWED;
        drawn_m[0] *= stays;
        drawn_m[1] *= stays;
    }
    felt_n[0] -= config->stiffness_npm * drawn_m[0];
    felt_n[1] -= config->stiffness_npm * drawn_m[1];
    return renewed;
}

/* Of a share that was paid for where renewing all takes paid_j, that which may be renewed where it
 * takes takes_j: the place has moved since. */
static inline sp_real sp_drag_afforded(sp_real share, sp_real paid_j, sp_real takes_j)
{
    if (!(takes_j > paid_j)) {
        return share;
    }
    const int some = paid_j > (sp_real)0 && takes_j > SP_SMALLEST;
    const sp_real part = some ? paid_j / takes_j : (sp_real)0;
    return part < (sp_real)1 ? share * part : share;
}

/* Renew a share of n branches, of which g is the curve; slow: their states in double, or none. */
static inline void sp_drag_renew(sp_real share, uint32_t n, const sp_real *g, sp_real *held,
                                 double *slow)
{
    for (uint32_t i = 0; i < n; i++) {
        const sp_real more = share * (g[i] - held[i]);
        held[i] = sp_flushed(sp_bounded(held[i] + more));
        if (slow != NULL) {
            slow[i] = sp_flushed_double(sp_bounded_double(slow[i] + (double)more));
        }
    }
}

#endif
