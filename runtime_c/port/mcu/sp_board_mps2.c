/* ARM MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7). */
#include "sp_arm.h"
#include "sp_port.h"

enum { CORE_HZ = 25000000 };

void sp_board_start(float period_s)
{
    sp_arm_start_systick((float)CORE_HZ, period_s);
}
