/* Onset: no force at or above the surface, the model's force from 1/onset_per_m (m) of depth on,
 * and a linear rise between. A forest does not give 0 at depth 0. */
#ifndef SP_CONTACT_H
#define SP_CONTACT_H

#include "sp_real.h"

/* Scale the force by depth x near the surface, from 0 at the surface to all of it at
 * 1/onset_per_m: contact begins without a step in force. */
static inline sp_real sp_contact_onset(sp_real onset_per_m, sp_real x, sp_real force_n)
{
    const sp_real fraction = x * onset_per_m;
    if (!(fraction > (sp_real)0)) {
        return (sp_real)0;
    }
    return fraction < (sp_real)1 ? force_n * fraction : force_n;
}

#endif
