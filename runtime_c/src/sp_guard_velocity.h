/* Guard of the device's own velocity: a value that is not finite, or faster than a hand, is
 * replaced by the last good one, and the tick counts as held: a dead channel trips the watchdog. */
#ifndef SP_GUARD_VELOCITY_H
#define SP_GUARD_VELOCITY_H

#include "sp_notes.h"
#include "sp_number.h"

static inline sp_real sp_guard_velocity(sp_real max_mps, sp_real *good_mps, sp_real v, int *notes)
{
    if (!(sp_abs(v) <= max_mps)) { /* a NaN is not */
        *notes |= SP_NOTE_HELD;
        return *good_mps;
    }
    *good_mps = v;
    return v;
}

#endif
