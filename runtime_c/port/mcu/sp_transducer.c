/* The hand's side of a board that has neither sensor nor motor, such as an emulated one. Replace
 * this file by your encoder and drive. */
#include "sp_port.h"

/* A chip begins with slow clocks: set those that sp_board_*.c counts on, as the vendor's
 * SystemClock_Config does, or a period is many times as long. An emulator has no others. */
void sp_hand_start(void)
{
}

int sp_hand_motion(float *position_m)
{
    (void)position_m;
    return 0;
}

void sp_hand_force(float force_n)
{
    (void)force_n;
}
