#include "sp_port.h"

#include "sp_bytes.h"
#include "sp_cpu.h"

static sp_bytes received;
static sp_bytes to_send;
static volatile uint32_t lost;
static volatile uint32_t periods;

void sp_port_start(float period_s)
{
    sp_board_start(period_s);
    sp_cpu_let_interrupts();
}

int sp_port_read(uint8_t *byte)
{
    return sp_bytes_take(&received, byte);
}

void sp_port_write(const uint8_t *bytes, uint32_t n)
{
    if (n > SP_BYTES_CAPACITY - sp_bytes_waiting(&to_send)) {
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        sp_bytes_put(&to_send, bytes[i]);
    }
    sp_cpu_hold_interrupts();
    sp_board_send();
    sp_cpu_let_interrupts();
}

uint32_t sp_port_periods(void)
{
    sp_cpu_hold_interrupts();
    const uint32_t passed = periods;
    periods = 0;
    sp_cpu_let_interrupts();
    return passed;
}

void sp_port_sleep(void)
{
    /* Held back, so that nothing comes between the look and the sleep. */
    sp_cpu_hold_interrupts();
    if (periods == 0 && sp_bytes_waiting(&received) == 0) {
        sp_cpu_sleep();
    }
    sp_cpu_let_interrupts();
}

uint32_t sp_port_overflow(void)
{
    return received.overflow + lost;
}

void sp_port_received(uint8_t byte)
{
    sp_bytes_put(&received, byte);
}

void sp_port_lost(void)
{
    lost = lost + 1;
}

void sp_port_period(void)
{
    periods = periods + 1;
}

int sp_port_next(uint8_t *byte)
{
    return sp_bytes_take(&to_send, byte);
}
