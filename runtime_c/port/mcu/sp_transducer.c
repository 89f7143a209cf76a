/* The hand's side of a board that has neither sensor nor motor, such as an emulated one. Replace
 * this file by your encoder and drive. */
#include "sp_port.h"

int sp_hand_motion(float *position_m, float *velocity_mps)
{
    (void)position_m;
    (void)velocity_mps;
    return 0;
}

void sp_hand_force(float force_n)
{
    (void)force_n;
}
