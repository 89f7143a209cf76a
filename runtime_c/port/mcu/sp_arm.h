/* Cortex-M: what the boards with one have in common. The board gives main its vectors. */
#ifndef SP_ARM_H
#define SP_ARM_H

#include <stdint.h>

#define SP_REGISTER(address) (*(volatile uint32_t *)(address))

enum { SP_ARM_INTERRUPTS = 64 };

/* Let interrupt `number` of the board through. */
static inline void sp_arm_enable(uint32_t number)
{
    SP_REGISTER(0xe000e100u + 4 * (number / 32)) = 1u << (number % 32);
}

/* sp_port_period() every period_s, by SysTick from the core's clock. */
void sp_arm_periods(float core_hz, float period_s);

/* Of the board: what to do on its interrupt `number`. */
void sp_board_interrupt(uint32_t number);

#endif
