/* Port of the loop to a microcontroller: reads the sensor, steps the scene, drives the motor. */
#include "sp_port.h"

#include "sp_cpu.h"

static volatile uint32_t periods;

void sp_port_start(float period_s)
{
    sp_board_start(period_s);
    sp_cpu_enable_interrupts();
}

/* Periods since the last call; 2 or more means that ticks were missed. */
uint32_t sp_port_take_elapsed_periods(void)
{
    sp_cpu_disable_interrupts();
    const uint32_t passed = periods;
    periods = 0;
    sp_cpu_enable_interrupts();
    return passed;
}

/* Sleep until an interrupt, unless a period has passed already. */
void sp_port_sleep(void)
{
    /* Held back, so that nothing comes between the look and the sleep. */
    sp_cpu_disable_interrupts();
    if (periods == 0) {
        sp_cpu_sleep();
    }
    sp_cpu_enable_interrupts();
}

void sp_port_on_period(void)
{
    periods = periods + 1;
}
