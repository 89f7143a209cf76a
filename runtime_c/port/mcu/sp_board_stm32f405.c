/* STM32F405 (Cortex-M4F) at its full speed, which sp_hand_start sets on a chip: after a reset it is
 * 16 MHz. The emulator has no other. */
#include "sp_arm.h"
#include "sp_port.h"

enum { CORE_HZ = 168000000 };

void sp_board_start(float period_s)
{
    sp_arm_start_systick((float)CORE_HZ, period_s);
}
