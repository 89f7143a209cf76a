/* ARM MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7): UART0 of the CMSDK. */
#include "sp_arm.h"
#include "sp_port.h"

#define UART_DATA SP_REGISTER(0x40004000u)
#define UART_STATE SP_REGISTER(0x40004004u)
#define UART_CTRL SP_REGISTER(0x40004008u)
#define UART_CLEAR SP_REGISTER(0x4000400cu)
#define UART_BAUD_DIVIDER SP_REGISTER(0x40004010u)

enum {
    CORE_HZ = 25000000,
    STATE_FULL = 1,
    STATE_RECEIVED = 2,
    STATE_LOST = 8,
    CTRL_ALL = 15, /* both ways, each with its interrupt */
    CLEAR_SENT = 1,
    CLEAR_RECEIVED = 2,
    INTERRUPT_RECEIVED = 0,
    INTERRUPT_SENT = 1
};

void sp_board_start(float period_s)
{
    UART_BAUD_DIVIDER = CORE_HZ / SP_PORT_BAUD;
    UART_CTRL = CTRL_ALL;
    sp_arm_enable(INTERRUPT_RECEIVED);
    sp_arm_enable(INTERRUPT_SENT);
    sp_arm_periods((float)CORE_HZ, period_s);
}

void sp_board_send(void)
{
    uint8_t byte;
    while (!(UART_STATE & STATE_FULL) && sp_port_next(&byte)) {
        UART_DATA = byte;
    }
}

void sp_board_interrupt(uint32_t number)
{
    if (number == INTERRUPT_SENT) {
        UART_CLEAR = CLEAR_SENT;
        sp_board_send();
        return;
    }
    UART_CLEAR = CLEAR_RECEIVED;
    if (UART_STATE & STATE_LOST) {
        UART_STATE = STATE_LOST;
        sp_port_lost();
    }
    while (UART_STATE & STATE_RECEIVED) {
        sp_port_received((uint8_t)UART_DATA);
    }
}
