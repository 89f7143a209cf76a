/* Smoothing: an exponential moving average of the force, weight `alpha` on the newest. */
#ifndef SP_SMOOTH_H
#define SP_SMOOTH_H

#include "sp_number.h"

static inline sp_real sp_smooth(sp_real alpha, sp_real *smoothed, sp_real force_n)
{
    *smoothed = sp_flushed(*smoothed + alpha * (force_n - *smoothed));
    return *smoothed;
}

#endif
