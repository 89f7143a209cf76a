/* Depth as the passive model sees it where it stiffens steeply, or relaxes at another rate the
 * deeper it is pressed.
 *
 * Both are curves (sp_curve.h) of the share u of the trained depth: eight pieces up to u = 1, and
 * one that goes on. A stretched depth v(u) never falls. A pole whose rate depends on the depth,
 *
 *     h' = g' - r(u) h,   h[n] = h[n-1] + d - loss(u) (h[n-1] + d/2),   d = g[n] - g[n-1]
 *
 * dissipates for every r(u) > 0 (loss 0 to 1): what it holds relaxes towards g as it was halfway.
 */
#ifndef SP_DEPTH_H
#define SP_DEPTH_H

#include <stdint.h>

#include "sp_curve.h"
#include "sp_number.h"

enum { SP_DEPTH_PIECES = 9 };

static inline sp_curve_place sp_depth_place(sp_real u)
{
    const double pieces = (double)SP_DEPTH_PIECES;
    return sp_curve_at(u * (sp_real)((pieces - 1.0) / pieces), SP_DEPTH_PIECES);
}

/* stretch: one cubic curve. */
static inline sp_real sp_depth_stretched(const sp_real *stretch, sp_curve_place place)
{
    sp_real v;
    sp_curve(stretch, 3, 1, place, &v);
    return v;
}

/* Each pole has an input of its own: g now, `before` at the last tick. loss: straight curves. */
static inline void sp_depth_poles(const sp_real *loss, uint32_t n_poles, sp_curve_place place,
                                  const sp_real *g, sp_real *before, sp_real *h)
{
    const sp_real *term = loss + place.piece * 2 * n_poles;
    for (uint32_t i = 0; i < n_poles; i++) {
        const sp_real lost = term[i] * place.way + term[n_poles + i];
        const sp_real rise = g[i] - before[i];
        const sp_real held = sp_bounded(h[i]);
        h[i] = sp_flushed(held + (rise - lost * (held + (sp_real)0.5 * rise)));
        before[i] = g[i];
    }
}

/* The same kept in double (sp_slow_poles.h); out: in the scene's type. */
static inline void sp_depth_slow_poles(const sp_real *loss, uint32_t n_poles, sp_curve_place place,
                                       const sp_real *g, sp_real *before, double *h, sp_real *out)
{
    const sp_real *term = loss + place.piece * 2 * n_poles;
    for (uint32_t i = 0; i < n_poles; i++) {
        const double lost = (double)(term[i] * place.way + term[n_poles + i]);
        const double rise = (double)(g[i] - before[i]);
        const double held = sp_bounded_double(h[i]);
        h[i] = sp_flushed_double(held + (rise - lost * (held + 0.5 * rise)));
        out[i] = (sp_real)h[i];
        before[i] = g[i];
    }
}

#endif
