/* Smoothing: exponential moving average with weight `alpha` on the newest value. */
#ifndef SP_SMOOTH_H
#define SP_SMOOTH_H

#include "sp_number.h"

static inline sp_real sp_smooth(sp_real alpha, sp_real *smoothed, sp_real newest)
{
    *smoothed = sp_flush_denormal(*smoothed + alpha * (newest - *smoothed));
    return *smoothed;
}

#endif
