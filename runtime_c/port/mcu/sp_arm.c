/* Start of a Cortex-M with a floating-point unit, and its timer. */
#include "sp_arm.h"

#include "sp_port.h"

#define CPACR SP_REGISTER(0xe000ed88u)
#define SYST_CSR SP_REGISTER(0xe000e010u)
#define SYST_RVR SP_REGISTER(0xe000e014u)
#define SYST_CVR SP_REGISTER(0xe000e018u)

enum { FULL_ACCESS_FPU = 0xf << 20, SYST_ON = 7, SYST_MAX = 1 << 24 };

/* Of the linker script. */
extern uint32_t sp_stack_top[], sp_data_load[], sp_data[], sp_data_end[], sp_bss[], sp_bss_end[];

int main(void);
void sp_arm_reset(void);

static uint32_t turns_per_period; /* turns of SysTick in a period: it counts to 2^24 only */
static uint32_t turn;

/* Start the core's timer so that a period of the scene is 2^k of its turns: its counter has 24
 * bits. */
void sp_arm_start_systick(float core_hz, float period_s)
{
    uint32_t counts = (uint32_t)(core_hz * period_s + 0.5f);
    for (turns_per_period = 1; counts > SYST_MAX;
         turns_per_period *= 2) { /* a period is 2^k turns */
        counts /= 2;
    }
    SYST_RVR = counts - 1;
    SYST_CVR = 0;
    SYST_CSR = SYST_ON;
}

/* Interrupt of the timer: count its turns, and tell the port of each whole period. */
static void on_systick(void)
{
    turn++;
    if (turn >= turns_per_period) {
        turn = 0;
        sp_port_on_period();
    }
}

/* A fault: the motor must not stay on. A debugger finds the cause. */
static void on_fault(void)
{
    sp_hand_force(0.0f);
    for (;;) {
    }
}

/* Entry after a reset: enable the FPU, copy initialised data, clear the rest, call main. It
 * runs before main: nothing here may use the FPU, memcpy or a static variable. */
void sp_arm_reset(void)
{
    CPACR |= FULL_ACCESS_FPU;
    __asm__ volatile("dsb\n isb" ::: "memory");
    const uint32_t *from = sp_data_load;
    for (volatile uint32_t *to = sp_data; to < sp_data_end; to++) {
        *to = *from++;
    }
    for (volatile uint32_t *to = sp_bss; to < sp_bss_end; to++) {
        *to = 0;
    }
    (void)main();
    on_fault();
}

typedef struct {
    const uint32_t *stack_top;
    void (*reset)(void);
    void (*exceptions[13])(void);
    void (*systick)(void);
} vectors;

#define FOUR(f) f, f, f, f
extern const vectors sp_arm_vectors;
__attribute__((section(".vectors"), used)) const vectors sp_arm_vectors = {
    .stack_top = sp_stack_top,
    .reset = sp_arm_reset,
    .exceptions = {FOUR(on_fault), FOUR(on_fault), FOUR(on_fault), on_fault},
    .systick = on_systick,
};
