/* The few number helpers that the units share. */
#ifndef SP_NUMBER_H
#define SP_NUMBER_H

#include "sp_real.h"

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) ||                                               \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0)
#error                                                                                             \
    "springpot needs IEEE arithmetic: build without -ffast-math, -ffinite-math-only (see flags.mk)"
#endif

/* A function that few ticks call, out of the way of the others; and a long one that is called in
 * two places: a copy in each would cost the inlining within it. */
#if defined(__GNUC__)
#define SP_COLD __attribute__((noinline, cold, unused)) static
#define SP_NOINLINE __attribute__((noinline)) static
#else
#define SP_COLD static inline
#define SP_NOINLINE static
#endif

/* A length of time: positive, not infinite and not NaN, without libm. */
static inline int sp_is_valid_dt(sp_real x)
{
    return x == x && x > (sp_real)0 && x <= SP_REAL_MAX;
}

/* Values below this are 0: a denormal costs a hundred times a number's time on some processors. */
#define SP_FLUSH_BELOW_DOUBLE 1e-30
#define SP_FLUSH_BELOW ((sp_real)SP_FLUSH_BELOW_DOUBLE)

static inline sp_real sp_flush_denormal(sp_real x)
{
    return sp_abs(x) < SP_FLUSH_BELOW ? (sp_real)0 : x;
}

/* The same for states that are kept in double whatever the scene's number type. */
static inline double sp_flush_denormal_double(double x)
{
    return fabs(x) < SP_FLUSH_BELOW_DOUBLE ? 0.0 : x;
}

/* Far above every state of a model in its units. Where bounds of one step do not add up to a bound
 * of the state (a measured time step, a mass on a spring), it is stated. The analysis shows that no
 * NaN comes here; one would become the largest. */
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
