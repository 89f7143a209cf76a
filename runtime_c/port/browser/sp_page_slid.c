#include <stddef.h>

#include "sp_page_touch.h"

int sp_page_slides(void)
{
    return 1;
}

int sp_page_touch(sp_state *state, const sp_real at_m[3], sp_real velocity_mps, sp_real force_n[3])
{
    (void)velocity_mps;
    return sp_step3(state, at_m, NULL, force_n);
}
