/* Number helpers that the units share. */
#ifndef SP_NUMBER_H
#define SP_NUMBER_H

#include "sp_real.h"

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) ||                                               \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0)
#error                                                                                             \
    "springpot needs IEEE arithmetic: build without -ffast-math, -ffinite-math-only (see flags.mk)"
#endif

/* SP_COLD: rarely called, kept out of line. SP_NOINLINE: long and called twice; inlining it would
 * stop the compiler from inlining inside it. */
#if defined(__GNUC__)
#define SP_COLD __attribute__((noinline, cold, unused)) static
#define SP_NOINLINE __attribute__((noinline)) static
#else
#define SP_COLD static inline
#define SP_NOINLINE static
#endif

/* Returns 1 if x is a length of time: positive, finite, not NaN. Without libm. */
static inline int sp_is_valid_dt(sp_real x)
{
    return x == x && x > (sp_real)0 && x <= SP_REAL_MAX;
}

/* Smaller values become 0: on some processors a denormal takes a hundred times as long as other
 * numbers. */
#define SP_FLUSH_BELOW_DOUBLE 1e-30
#define SP_FLUSH_BELOW ((sp_real)SP_FLUSH_BELOW_DOUBLE)

static inline sp_real sp_flush_denormal(sp_real x)
{
    return sp_abs(x) < SP_FLUSH_BELOW ? (sp_real)0 : x;
}

/* For states that are double whatever the scene's number type is. */
static inline double sp_flush_denormal_double(double x)
{
    return fabs(x) < SP_FLUSH_BELOW_DOUBLE ? 0.0 : x;
}

/* Bound of every model state, far above any real value. It lets the static analyser prove finite
 * states where one step alone gives no bound (a measured time step, a mass on a spring). NaN does
 * not come here, as the analyser shows; it would become the largest value. */
#define SP_MAX_STATE 1e6

static inline double sp_clamp_state_double(double x)
{
    const double below = x < SP_MAX_STATE ? x : SP_MAX_STATE;
    return below > -SP_MAX_STATE ? below : -SP_MAX_STATE;
}

static inline sp_real sp_clamp_state(sp_real x)
{
    const sp_real below = x < (sp_real)SP_MAX_STATE ? x : (sp_real)SP_MAX_STATE;
    return below > (sp_real)-SP_MAX_STATE ? below : (sp_real)-SP_MAX_STATE;
}

#endif
