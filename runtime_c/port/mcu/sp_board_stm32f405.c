/* STM32F405 (Cortex-M4F). The clocks are at their full speed when main begins, as the vendor's
 * SystemClock_Config leaves them (the emulator has no others). */
#include "sp_arm.h"
#include "sp_port.h"

enum { CORE_HZ = 168000000 };

void sp_board_start(float period_s)
{
    sp_arm_start_systick((float)CORE_HZ, period_s);
}
