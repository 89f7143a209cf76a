/* One tick of a scene with a map under a tool of three axes: sp_page_held.c for a scene that holds
 * the place, sp_page_slid.c for one with a lateral force. */
#ifndef SP_PAGE_TOUCH_H
#define SP_PAGE_TOUCH_H

#include "sp_scene.h"

/* 1 if the tool slides on the object. */
int sp_page_slides(void);

/* x, y and depth, m, and the speed along the depth; force along them, N. Returns the notes. */
int sp_page_touch(sp_state *state, const sp_real at_m[3], sp_real velocity_mps, sp_real force_n[3]);

#endif
