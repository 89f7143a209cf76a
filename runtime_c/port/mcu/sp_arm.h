/* Cortex-M: what the boards with one have in common. The board gives main its vectors. */
#ifndef SP_ARM_H
#define SP_ARM_H

#include <stdint.h>

#define SP_REGISTER(address) (*(volatile uint32_t *)(address))

/* sp_port_on_period() every period_s, by SysTick from the core's clock. */
void sp_arm_start_systick(float core_hz, float period_s);

#endif
