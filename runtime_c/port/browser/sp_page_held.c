#include "sp_page_touch.h"

int sp_page_slides(void)
{
    return 0;
}

/* A place that is felt already changes nothing. */
int sp_page_touch(sp_state *state, const sp_real at_m[3], sp_real velocity_mps, sp_real force_n[3])
{
    sp_place(state, at_m[0], at_m[1]);
    force_n[0] = (sp_real)0;
    force_n[1] = (sp_real)0;
    return sp_step(state, at_m[2], velocity_mps, &force_n[2]);
}
