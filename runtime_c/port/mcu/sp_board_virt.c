/* RISC-V board of the emulator ("virt"), rv32imafc: start and the timer of the CLINT. */
#include "sp_port.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define MTIMECMP_LOW REGISTER(0x02004000u)
#define MTIMECMP_HIGH REGISTER(0x02004004u)
#define MTIME_LOW REGISTER(0x0200bff8u)
#define MTIME_HIGH REGISTER(0x0200bffcu)

enum { TIMER_HZ = 10000000, CAUSE_TIMER = 7 };

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

/* Time of the board's timer, 64 bits in two halves: read again if the upper one has changed. */
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
    period_counts = (uint32_t)((float)TIMER_HZ * period_s + 0.5f);
    next_period = now() + period_counts;
    set_timer(next_period);
    __asm__ volatile("csrs mie, %0" ::"r"(1u << CAUSE_TIMER));
}

static void on_timer(void)
{
    next_period += period_counts;
    set_timer(next_period);
    sp_port_on_period();
}

/* Entry of every interrupt and fault of this RISC-V board. */
__attribute__((interrupt("machine"), aligned(4))) void sp_virt_trap(void)
{
    uint32_t cause;
    __asm__ volatile("csrr %0, mcause" : "=r"(cause));
    if (cause == (1u << 31 | CAUSE_TIMER)) {
        on_timer();
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
