/* RISC-V board of the emulator ("virt"), rv32imafc: start, timer of the CLINT, NS16550 UART. */
#include "sp_port.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define BYTE(address) (*(volatile uint8_t *)(address))
#define MTIMECMP_LOW REGISTER(0x02004000u)
#define MTIMECMP_HIGH REGISTER(0x02004004u)
#define MTIME_LOW REGISTER(0x0200bff8u)
#define MTIME_HIGH REGISTER(0x0200bffcu)
#define PLIC_PRIORITY(number) REGISTER(0x0c000000u + 4 * (number))
#define PLIC_ENABLE REGISTER(0x0c002000u)
#define PLIC_THRESHOLD REGISTER(0x0c200000u)
#define PLIC_CLAIM REGISTER(0x0c200004u)
#define UART_DATA BYTE(0x10000000u)
#define UART_INTERRUPTS BYTE(0x10000001u)
#define UART_FIFO BYTE(0x10000002u)
#define UART_LINE BYTE(0x10000003u)
#define UART_STATUS BYTE(0x10000005u)

enum {
    TIMER_HZ = 10000000,
    INTERRUPT_UART = 10,
    WHEN_RECEIVED = 1,
    WHEN_EMPTY = 2,
    FIFO_ON = 7,
    EIGHT_BITS = 3,
    STATUS_RECEIVED = 1,
    STATUS_LOST = 2,
    STATUS_EMPTY = 0x20,
    CAUSE_TIMER = 7,
    CAUSE_EXTERNAL = 11
};

/* Of the linker script. */
extern uint32_t sp_bss[], sp_bss_end[];

int main(void);
void sp_virt_reset(void);
void sp_virt_trap(void);

static uint32_t period_counts;
static uint64_t next_period;

static void set_timer(uint64_t when)
{
    MTIMECMP_HIGH = 0xffffffffu; /* no early alarm between the two halves */
    MTIMECMP_LOW = (uint32_t)when;
    MTIMECMP_HIGH = (uint32_t)(when >> 32);
}

static uint64_t now(void)
{
    uint32_t high, low;
    do {
        high = MTIME_HIGH;
        low = MTIME_LOW;
    } while (high != MTIME_HIGH);
    return (uint64_t)high << 32 | low;
}

void sp_board_start(float period_s)
{
    UART_LINE = EIGHT_BITS;
    UART_FIFO = FIFO_ON;
    UART_INTERRUPTS = WHEN_RECEIVED;
    PLIC_PRIORITY(INTERRUPT_UART) = 1;
    PLIC_ENABLE = 1u << INTERRUPT_UART;
    PLIC_THRESHOLD = 0;
    period_counts = (uint32_t)((float)TIMER_HZ * period_s + 0.5f);
    next_period = now() + period_counts;
    set_timer(next_period);
    __asm__ volatile("csrs mie, %0" ::"r"(1u << CAUSE_TIMER | 1u << CAUSE_EXTERNAL));
}

void sp_board_send(void)
{
    uint8_t byte;
    while (UART_STATUS & STATUS_EMPTY) {
        if (!sp_port_next(&byte)) {
            UART_INTERRUPTS = WHEN_RECEIVED;
            return;
        }
        UART_DATA = byte;
    }
    UART_INTERRUPTS = WHEN_RECEIVED | WHEN_EMPTY;
}

static void on_uart(void)
{
    for (uint8_t status; (status = UART_STATUS) & STATUS_RECEIVED;) {
        if (status & STATUS_LOST) {
            sp_port_lost();
        }
        sp_port_received(UART_DATA);
    }
    sp_board_send();
}

static void on_timer(void)
{
    next_period += period_counts;
    set_timer(next_period);
    sp_port_period();
}

__attribute__((interrupt("machine"), aligned(4))) void sp_virt_trap(void)
{
    uint32_t cause;
    __asm__ volatile("csrr %0, mcause" : "=r"(cause));
    if (cause == (1u << 31 | CAUSE_TIMER)) {
        on_timer();
    } else if (cause == (1u << 31 | CAUSE_EXTERNAL)) {
        const uint32_t number = PLIC_CLAIM;
        on_uart();
        PLIC_CLAIM = number;
    } else { /* a fault: the motor must not stay on */
        sp_hand_force(0.0f);
        for (;;) {
        }
    }
}

void sp_virt_reset(void)
{
    for (volatile uint32_t *to = sp_bss; to < sp_bss_end; to++) {
        *to = 0;
    }
    (void)main();
}

__asm__(".section .start, \"ax\"\n"
        ".globl _start\n"
        "_start:\n"
        ".option push\n"
        ".option norelax\n"
        "    la gp, __global_pointer$\n"
        ".option pop\n"
        "    la sp, sp_stack_top\n"
        "    li t0, 0x2000\n" /* mstatus.FS: floating point on */
        "    csrs mstatus, t0\n"
        "    fscsr zero\n"
        "    la t0, sp_virt_trap\n"
        "    csrw mtvec, t0\n"
        "    call sp_virt_reset\n"
        "1:  wfi\n"
        "    j 1b\n"
        ".text\n");
