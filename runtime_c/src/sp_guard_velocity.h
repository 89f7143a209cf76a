/* Guard of the device's own velocity: with a value that is not finite, or faster than a hand, the
 * sample is not taken: a dead channel trips the watchdog. */
#ifndef SP_GUARD_VELOCITY_H
#define SP_GUARD_VELOCITY_H

#include "sp_number.h"

static inline int sp_guard_plausible_velocity(sp_real max_mps, sp_real v)
{
    return v == v && v >= -max_mps && v <= max_mps; /* a NaN is not itself */
}

#endif
